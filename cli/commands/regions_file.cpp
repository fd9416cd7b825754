#include "cli/commands/regions_file.hpp"

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/json.hpp"
#include "pliant/forces/force.hpp"
#include "viewer/forces.hpp"

namespace pliant::cli {
namespace {

// `force` is the force of the report, in the world; null: a group.
Json force_json(const ForceReport& report, bool is_surface, const Force* force, int frame) {
  const auto& [name, kind, sampled, selection, push, counts, outline] = report;
  Json json = {{"name", name},
               {"kind", kind},
               {"magnitude", sampled->magnitude},
               {"deformationRadius", sampled->deformation_radius},
               {"forceRadius", sampled->force_radius}};
  if (force) {
    viewer::for_each_value(*force,
                           [&](std::string_view attribute, const viewer::ValueAt& value_at) {
                             json[std::string(attribute)] = value_at(frame);
                           });
  } else {
    json["center"] = to_json(std::get<PointForce>(sampled->kind).center);
  }
  if (is_surface) {
    json.update(to_json(counts));
  } else {
    json["deformationBox"] = to_json(selection.deformation);
    json["forceBox"] = to_json(selection.force);
    json["region"] = selection.region < 0 ? Json(nullptr) : Json(selection.region);
  }
  json["pushedNodes"] = push.node_count;
  json["load"] = to_json(push.sum);
  return json;
}

Json contacts_json(const std::vector<ContactFacts>& contacts, const Scene& scene) {
  Json json = Json::array();
  for (const ContactFacts& facts : contacts) {
    json.push_back({{"collider", scene.colliders[static_cast<std::size_t>(facts.collider)].name},
                    {"nodes", facts.nodes.size()},
                    {"force", to_json(facts.force)}});
  }
  return json;
}

Json surface_json(const Simulation& simulation, std::size_t surface, const SurfaceReport& report,
                  const std::map<std::string_view, const Force*>& named) {
  Json regions = Json::array();
  for (std::size_t k = 0; k < report.regions.size(); ++k) {
    const Region& region = report.regions[k];
    Json parts = Json::array();
    for (const Box& part : region.parts) parts.push_back(to_json(part));
    const bool is_solved = report.regions[k].is_solved();
    regions.push_back({{"solved", is_solved}, {"box", to_json(region.box)}, {"parts", parts}});
  }
  Json forces = Json::array();
  for (const ForceReport& force : report.forces) {
    if (force.kind == "group") {
      forces.push_back(force_json(force, report.is_surface, nullptr, report.frame));
      continue;
    }
    const Force placed = simulation.in_world(*named.find(force.name)->second, report.frame);
    forces.push_back(force_json(force, report.is_surface, &placed, report.frame));
  }
  Json json = {{"name", simulation.scene().surfaces[surface].name},
               {"solved", report.is_solved},
               {"selected", to_json(report.selected)},
               {"steps", report.is_solved ? report.steps.count : 0},
               {"dt", report.is_solved ? Json(report.steps.length) : Json(nullptr)},
               {"unknowns", report.unknown_count},
               {"recovering", report.recovering},
               {"settled", report.settled},
               {"regions", regions},
               {"forces", forces},
               {"contacts", contacts_json(report.contacts, simulation.scene())}};
  if (!report.is_surface) return json;
  for (const char* of_grid : {"selected", "regions"}) json.erase(of_grid);
  json["grid"] = nullptr;
  json["cut"] = report.cut ? Json(to_text(*report.cut)) : Json(nullptr);
  json["pieces"] = Json::array();
  for (const CutCounts& patch : report.patches) json["pieces"].push_back(to_json(patch));
  return json;
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

Result<void> RegionsFile::write(const FrameReport& report, const Simulation& simulation) {
  std::map<std::string_view, const Force*> named;
  for (const Force& force : simulation.scene().forces) named.emplace(force.name, &force);
  Json surfaces = Json::array();
  for (std::size_t k = 0; k < report.surfaces.size(); ++k) {
    if (was_interrupted()) return interrupted();
    surfaces.push_back(surface_json(simulation, k, report.surfaces[k], named));
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
