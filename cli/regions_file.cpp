#include "regions_file.hpp"

#include <utility>
#include <variant>

#include "json.hpp"
#include "pliant/forces/force.hpp"

namespace pliant::cli {
namespace {

// Adds the place and direction of the force, depending on its kind.
struct AddShape {
  Json& force;

  void operator()(const PointForce& point) const {
    force["center"] = to_json(point.center);
    if (force["kind"] != "group") force["direction"] = to_json(point.direction);
  }
  void operator()(const RadialForce& radial) const { force["center"] = to_json(radial.center); }
  void operator()(const LineForce& line) const {
    force["from"] = to_json(line.from);
    force["to"] = to_json(line.to);
    if (line.direction) force["direction"] = to_json(*line.direction);
  }
  void operator()(const UniformForce& uniform) const {
    force["direction"] = to_json(uniform.direction);
  }
  void operator()(const VortexForce& vortex) const {
    force["center"] = to_json(vortex.center);
    force["axis"] = to_json(vortex.axis);
    force["pull"] = vortex.pull;
  }
  void operator()(const NoiseForce& noise) const {
    force["center"] = to_json(noise.center);
    force["frequency"] = noise.frequency;
  }
  void operator()(const InertiaForce&) const {}
  void operator()(const FunctionForce&) const {}
};

Json force_json(const ForceReport& report) {
  const auto& [name, kind, sampled, selection, push] = report;
  Json json = {{"name", name},
               {"kind", kind},
               {"magnitude", sampled->magnitude},
               {"deformationRadius", sampled->deformation_radius},
               {"forceRadius", sampled->force_radius}};
  std::visit(AddShape{json}, sampled->shape);
  json["deformationBox"] = to_json(selection.deformation);
  json["forceBox"] = to_json(selection.force);
  json["region"] = selection.region < 0 ? Json(nullptr) : Json(selection.region);
  json["pushedNodes"] = push.node_count;
  json["load"] = to_json(push.sum);
  return json;
}

Json surface_json(const SurfaceReport& report, const std::string& name) {
  Box selected;
  Json regions = Json::array();
  for (std::size_t k = 0; k < report.regions.size(); ++k) {
    const Region& region = report.regions[k];
    selected.include(region.box);
    Json parts = Json::array();
    for (const Box& part : region.parts) parts.push_back(to_json(part));
    const bool is_solved = report.region_is_solved[k];
    regions.push_back({{"solved", is_solved}, {"box", to_json(region.box)}, {"parts", parts}});
  }
  Json forces = Json::array();
  for (const ForceReport& force : report.forces) forces.push_back(force_json(force));
  return {{"name", name},
          {"solved", report.is_solved},
          {"selected", to_json(selected)},
          {"steps", report.is_solved ? report.steps.count : 0},
          {"dt", report.is_solved ? Json(report.steps.length) : Json(nullptr)},
          {"unknowns", report.unknown_count},
          {"recovering", report.recovering},
          {"settled", report.settled},
          {"regions", regions},
          {"forces", forces}};
}

}  // namespace

Result<RegionsFile> RegionsFile::create(const std::filesystem::path& file, const Scene& scene) {
  auto atomic = AtomicFile::create(file);
  if (!atomic) return fail(atomic.error());
  RegionsFile regions(*std::move(atomic));
  const Json fps = scene.fps;
  const std::string head = "{\"version\": 1, \"fps\": " + fps.dump() + ", \"frames\": [";
  if (auto written = regions.file_.write(head); !written) return fail(written.error());
  return regions;
}

Result<void> RegionsFile::write(const FrameReport& report, const Scene& scene) {
  Json surfaces = Json::array();
  for (std::size_t k = 0; k < report.surfaces.size(); ++k) {
    surfaces.push_back(surface_json(report.surfaces[k], scene.surfaces[k].name));
  }
  const Json frame = {{"frame", report.frame}, {"surfaces", surfaces}};
  const char* const before = std::exchange(is_first_, false) ? "\n" : ",\n";
  return file_.write(before + frame.dump());
}

Result<void> RegionsFile::finish(const SolverCounts& counts) {
  const Json solver = {{"analyses", counts.analyses},
                       {"factorizations", counts.factorizations},
                       {"solves", counts.solves}};
  if (auto written = file_.write("\n], \"solver\": " + solver.dump() + "}\n"); !written) {
    return written;
  }
  return file_.commit();
}

}  // namespace pliant::cli
