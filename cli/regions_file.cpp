#include "regions_file.hpp"

#include <utility>
#include <variant>

#include <nlohmann/json.hpp>

namespace pliant::cli {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Box& box) {
  if (box.is_empty()) return nullptr;
  return {{"columns", {box.i0, box.i1}}, {"rows", {box.j0, box.j1}}};
}

Json to_json(const Vector3d& vector) { return {vector[0], vector[1], vector[2]}; }

// Where the force is and where it points, as its kind has it.
void add_shape(const ForceShape& shape, Json& force) {
  if (const auto* point = std::get_if<PointForce>(&shape)) {
    force["center"] = to_json(point->center);
    force["direction"] = to_json(point->direction);
  } else if (const auto* radial = std::get_if<RadialForce>(&shape)) {
    force["center"] = to_json(radial->center);
  } else if (const auto* line = std::get_if<LineForce>(&shape)) {
    force["from"] = to_json(line->from);
    force["to"] = to_json(line->to);
    if (line->direction) force["direction"] = to_json(*line->direction);
  }
}

Json to_json(const ForceReport& report, const Scene& scene) {
  const auto& [force, sampled, selection, push] = report;
  Json json = {{"name", scene.forces[force].name},
               {"magnitude", sampled.magnitude},
               {"deformationRadius", sampled.deformation_radius},
               {"forceRadius", sampled.force_radius}};
  add_shape(sampled.shape, json);
  json["deformationBox"] = to_json(selection.deformation);
  json["forceBox"] = to_json(selection.force);
  json["region"] = selection.region < 0 ? Json(nullptr) : Json(selection.region);
  json["pushedNodes"] = push.node_count;
  json["load"] = to_json(push.sum);
  return json;
}

Json to_json(const SurfaceReport& report, const std::string& name, const Scene& scene) {
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
  for (const ForceReport& force : report.forces) forces.push_back(to_json(force, scene));
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
    surfaces.push_back(to_json(report.surfaces[k], scene.surfaces[k].name, scene));
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
