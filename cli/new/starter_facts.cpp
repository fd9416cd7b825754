#include "cli/new/starter_facts.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "pliant/feedback/preview.hpp"
#include "pliant/files/obj/read_obj.hpp"
#include "pliant/scene/read.hpp"

namespace pliant::cli {
namespace {

// Half the width of what moves. A surface of triangles: the radius that selects it.
double reach_of(const Scene& scene, const Surface& surface, const RestShape& shape,
                const Preview& preview) {
  if (shape.grid) {
    const auto& [i0, i1, j0, j1] = preview.selected;
    const double along_u = (i1 - i0) * shape.grid->hu, along_v = (j1 - j0) * shape.grid->hv;
    return std::min(along_u, along_v) / 2;
  }
  if (surface.solver.region == SolvedRegion::All) return 0.5;
  double radius = 0;
  for (const Force& force : scene.forces) {
    radius = std::max(radius, force.deformation_radius.at(*preview.frame)[0]);
  }
  return radius / summary_of(shape)->unit[0];
}

Result<Simulation> simulation_of(const std::string& text, const StarterSource& source) {
  Result<Scene> scene =
      parse_scene(text, source.name, source.folder, source.root, source.options.should_stop);
  if (!scene) return fail(scene.error());
  if (!source.obj.empty()) {
    Result<Mesh> mesh = parse_obj(source.obj, source.name);
    if (!mesh) return fail(mesh.error());
    scene->surfaces[source.surface].shape = *std::move(mesh);
  }
  return Simulation::make(*std::move(scene), source.options);
}

}  // namespace

Result<MeshPiece> measure(const std::string& text, const StarterSource& source) {
  const auto simulation = simulation_of(text, source);
  if (!simulation) return fail(simulation.error());
  return largest_piece(simulation->rest_shapes()[source.surface]);
}

Result<StarterFacts> look_at(const std::string& text, const StarterSource& source) {
  const auto simulation = simulation_of(text, source);
  if (!simulation) return fail(simulation.error());
  const auto preview = preview_slowest(*simulation, source.surface, source.options);
  if (!preview) return fail(preview.error());
  const Scene& scene = simulation->scene();
  const RestShape& shape = simulation->rest_shapes()[source.surface];
  StarterFacts facts{.size = largest_piece(shape).diagonal()};
  facts.is_by_inertia = std::ranges::any_of(scene.forces, [](const Force& force) {
    return std::holds_alternative<InertiaChannels>(force.kind);
  });
  if (!*preview || !(*preview)->frame) return facts;
  facts.selects = true;
  facts.is_solvable = (*preview)->is_solvable;
  facts.is_held = (*preview)->is_held;
  facts.reach = reach_of(scene, scene.surfaces[source.surface], shape, **preview);
  for (const RegionPreview& region : (*preview)->regions) {
    if (!region.has_vibration) continue;
    facts.frequency = facts.frequency == 0 ? region.first_frequency
                                           : std::min(facts.frequency, region.first_frequency);
  }
  return facts;
}

Result<void> check_moves(const StarterFacts& facts) {
  if (!facts.selects) return invalid("no force of the starter selects a vertex of the mesh");
  if (!facts.is_solvable) return invalid("no node of the mesh can move: all are on its border");
  if (!facts.is_held) {
    return invalid(
        "nothing holds the mesh: it, or a piece of it, has no border; this starter needs one, such "
        "as the rim of a bowl");
  }
  if (facts.frequency == 0) {
    return invalid(
        fmt::format("the mesh has too many nodes to find its frequency: more than {} "
                    "would move; choose a coarser one",
                    most_vibrating_nodes));
  }
  return {};
}

Result<double> played_peak(const std::string& text, const StarterSource& source, double until) {
  const auto simulation = simulation_of(text, source);
  if (!simulation) return fail(simulation.error());
  const auto played = play_forces(*simulation, source.surface, until, source.options);
  if (!played) return fail(played.error());
  return played->peak;
}

Result<StarterFacts> look_and_play(const std::string& text, const StarterSource& source) {
  auto facts = look_at(text, source);
  if (!facts) return facts;
  if (auto moves = check_moves(*facts); !moves) return fail(moves.error());
  const auto peak = played_peak(text, source);
  if (!peak) return fail(peak.error());
  facts->peak = *peak;
  return facts;
}

}  // namespace pliant::cli
