#include "pliant/simulation/report_json.hpp"

#include <map>
#include <string_view>
#include <variant>

#include <nlohmann/json.hpp>

#include "pliant/forces/force.hpp"
#include "pliant/scene/channel_values.hpp"
#include "pliant/simulation/live.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Vector3d& vector) { return {vector[0], vector[1], vector[2]}; }

Force in_world(const Simulation& simulation, const Force& force, int frame) {
  return simulation.in_world(force, frame);
}

Force in_world(const LiveSimulation& live, const Force& force, int) { return live.in_world(force); }

// `force` is the force of the report, in the world; null: a group.
Json force_json(const ForceReport& report, bool is_surface, const Force* force, int frame) {
  const auto& [name, kind, sampled, selection, push, counts, outline] = report;
  Json json = {{"name", name},
               {"kind", kind},
               {"magnitude", sampled->magnitude},
               {"deformationRadius", sampled->deformation_radius},
               {"forceRadius", sampled->force_radius}};
  if (force) {
    for_each_value(*force, [&](std::string_view attribute, const ValueAt& value_at) {
      json[std::string(attribute)] =
          std::visit([](const auto& value) { return Json(value); }, value_at(frame));
    });
  } else {
    json["center"] = to_json(std::get<PointForce>(sampled->kind).center);
  }
  if (is_surface) {
    json.update(Json(counts));
  } else {
    json["deformationBox"] = selection.deformation;
    json["forceBox"] = selection.force;
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

template <class AnySimulation>
Json surface_json(const AnySimulation& simulation, std::size_t surface, const SurfaceReport& report,
                  const std::map<std::string_view, const Force*>& named) {
  Json regions = Json::array();
  for (std::size_t k = 0; k < report.regions.size(); ++k) {
    const Region& region = report.regions[k];
    const bool is_solved = report.regions[k].is_solved();
    regions.push_back({{"solved", is_solved}, {"box", region.box}, {"parts", region.parts}});
  }
  Json forces = Json::array();
  for (const ForceReport& force : report.forces) {
    if (force.kind == "group") {
      forces.push_back(force_json(force, report.is_surface, nullptr, report.frame));
      continue;
    }
    const Force placed = in_world(simulation, *named.find(force.name)->second, report.frame);
    forces.push_back(force_json(force, report.is_surface, &placed, report.frame));
  }
  Json json = {{"name", simulation.scene().surfaces[surface].name},
               {"solved", report.is_solved},
               {"selected", report.selected},
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
  json["pieces"] = report.patches;
  return json;
}

template <class AnySimulation>
Result<std::string> frame_json(const FrameReport& report, const AnySimulation& simulation,
                               const StopRequest& should_stop) {
  std::map<std::string_view, const Force*> named;
  for (const Force& force : simulation.scene().forces) named.emplace(force.name, &force);
  Json surfaces = Json::array();
  for (std::size_t k = 0; k < report.surfaces.size(); ++k) {
    if (is_stopped(should_stop)) return interrupted();
    surfaces.push_back(surface_json(simulation, k, report.surfaces[k], named));
  }
  const Json frame = {{"frame", report.frame}, {"surfaces", surfaces}};
  return frame.dump();
}

}  // namespace

Result<std::string> to_json(const FrameReport& report, const Simulation& simulation,
                            const StopRequest& should_stop) {
  return frame_json(report, simulation, should_stop);
}

Result<std::string> to_json(const FrameReport& report, const LiveSimulation& live,
                            const StopRequest& should_stop) {
  return frame_json(report, live, should_stop);
}

}  // namespace pliant
