#include "starter_facts.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "pliant/feedback/preview.hpp"
#include "pliant/mesh/read_obj.hpp"
#include "pliant/scene/read.hpp"

namespace pliant::cli {
namespace {

// Half the width of what moves. A surface of triangles: the radius that selects it.
double reach_of(const Scene& scene, const RestShape& shape, const Preview& preview) {
  if (shape.grid) {
    const auto& [i0, i1, j0, j1] = preview.selected;
    const double along_u = (i1 - i0) * shape.grid->hu, along_v = (j1 - j0) * shape.grid->hv;
    return std::min(along_u, along_v) / 2;
  }
  if (scene.surfaces.front().solver.region == SolvedRegion::All) return 0.5;
  double radius = 0;
  for (const Force& force : scene.forces) {
    radius = std::max(radius, force.deformation_radius.at(*preview.frame)[0]);
  }
  return radius / summary_of(shape)->unit[0];
}

// The preview of all forces on the first surface; null: nothing moves.
const Preview* find_preview(const std::vector<Preview>& previews) {
  const auto found = std::ranges::find_if(previews, [](const Preview& each) {
    return each.of == Preview::Of::All && each.surface == 0;
  });
  return found != previews.end() && found->frame ? &*found : nullptr;
}

Result<Simulation> simulation_of(const std::string& text, const StarterSource& source) {
  Result<Scene> scene = parse_scene(text, source.name, source.folder, source.root);
  if (!scene) return fail(scene.error());
  if (!source.obj.empty()) {
    Result<Mesh> mesh = parse_obj(source.obj, source.name);
    if (!mesh) return fail(mesh.error());
    scene->surfaces.front().shape = *std::move(mesh);
  }
  return Simulation::make(*std::move(scene), source.options);
}

StarterFacts facts_of(const Simulation& simulation) {
  const Field& vertices = simulation.rest_shapes().front().mesh.positions;
  return {.low = vertices.colwise().minCoeff().transpose(),
          .high = vertices.colwise().maxCoeff().transpose(),
          .vertices = vertices};
}

Result<double> peak_of(Simulation& simulation) {
  double peak = 0;
  Frame frame;
  for (const int number : simulation.frames()) {
    auto next = simulation.at(number, std::move(frame));
    if (!next) return fail(next.error());
    frame = *std::move(next);
    peak = std::max(peak, frame.surfaces().front().peak_displacement());
  }
  return peak;
}

}  // namespace

Result<StarterFacts> measure(const std::string& text, const StarterSource& source) {
  const auto simulation = simulation_of(text, source);
  if (!simulation) return fail(simulation.error());
  return facts_of(*simulation);
}

Result<StarterFacts> look_at(const std::string& text, const StarterSource& source) {
  auto simulation = simulation_of(text, source);
  if (!simulation) return fail(simulation.error());
  const auto previews = preview_forces(*simulation, source.options);
  if (!previews) return fail(previews.error());
  const Preview* const preview = find_preview(*previews);
  if (!preview) return invalid("no force of the starter selects a vertex of the mesh");

  const Scene& scene = simulation->scene();
  StarterFacts facts = facts_of(*simulation);
  facts.is_held = preview->is_held;
  const auto peak = peak_of(*simulation);
  if (!peak) return fail(peak.error());
  facts.peak = *peak;
  facts.reach = reach_of(scene, simulation->rest_shapes().front(), *preview);
  for (const RegionPreview& region : preview->regions) {
    if (!region.has_vibration) continue;
    facts.frequency = facts.frequency == 0 ? region.first_frequency
                                           : std::min(facts.frequency, region.first_frequency);
  }
  facts.is_by_inertia = std::ranges::any_of(scene.forces, [](const Force& force) {
    return std::holds_alternative<InertiaChannels>(force.kind);
  });
  if (!preview->is_solvable) return invalid("no node of the mesh can move: all are on its border");
  if (facts.is_held && facts.frequency == 0) {
    return invalid(
        fmt::format("the mesh has too many nodes to find its frequency: more than {} "
                    "would move; choose a coarser one",
                    most_previewed_unknowns));
  }
  return facts;
}

Result<double> played_peak(const std::string& text, const StarterSource& source) {
  auto simulation = simulation_of(text, source);
  if (!simulation) return fail(simulation.error());
  return peak_of(*simulation);
}

}  // namespace pliant::cli
