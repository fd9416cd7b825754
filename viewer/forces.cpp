#include "viewer/forces.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace pliant::viewer {
namespace {

Json channel_track(const Channel<1>& channel, const FrameSpan& frames) {
  return track(frames, [&](int frame) { return Json(channel.at(frame)[0]); });
}

// Parts of a scene by their names.
class Named {
 public:
  explicit Named(const Scene& scene) {
    for (const Group& group : scene.groups) groups_.emplace(group.name, &group);
    for (const Surface& surface : scene.surfaces) {
      // One with region="all" is solved whole.
      if (!surface.is_driven() && surface.solver.region == SolvedRegion::Forces)
        selected_.insert(surface.name);
    }
  }

  // Null: it has none.
  const Group* group_of(const Force& force) const {
    const auto found = groups_.find(force.group);
    return found == groups_.end() ? nullptr : found->second;
  }

  // Whether what has these targets selects a region of some surface.
  bool selects(const std::vector<std::string>& targets) const {
    if (targets.empty()) return !selected_.empty();
    return std::any_of(targets.begin(), targets.end(),
                       [&](const std::string& target) { return selected_.contains(target); });
  }

 private:
  std::map<std::string_view, const Group*> groups_;
  std::set<std::string_view> selected_;
};

// The value of an attribute of a force's kind.
Json value_of(const Force& force, std::string_view attribute, int frame) {
  Json found;
  for_each_value(force, [&](std::string_view name, const ValueAt& value_at) {
    if (name == attribute) found = to_json(value_at(frame));
  });
  return found;
}

Json force_json(const Simulation& simulation, const Named& named, const Force& force,
                const FrameSpan& frames) {
  const Group* const group = named.group_of(force);
  Json json = {{"name", force.name}, {"kind", kind_of(force)}, {"targets", force.targets}};
  if (group != nullptr) json["group"] = group->name;
  json["enabled"] = track(frames, [&](int frame) {
    return Json(force.enabled.at(frame) && (group == nullptr || group->enabled.at(frame)));
  });
  json["magnitude"] = channel_track(force.magnitude, frames);
  if (group == nullptr && named.selects(force.targets))
    json["deformationRadius"] = channel_track(force.deformation_radius, frames);
  json["forceRadius"] = channel_track(force.force_radius, frames);
  for_each_value(force, [&](std::string_view name, const ValueAt& value_at) {
    json[std::string(name)] =
        force.follow.empty() ? track(frames, value_at) : track(frames, [&](int frame) {
          return value_of(simulation.in_world(force, frame), name, frame);
        });
  });
  return json;
}

Json group_json(const Simulation& simulation, const Named& named, const Group& group,
                const FrameSpan& frames) {
  Json json = {{"name", group.name},
               {"kind", "group"},
               {"targets", group.targets},
               {"enabled", track(frames, [&](int frame) { return Json(group.enabled.at(frame)); })},
               {"center", track(frames, [&](int frame) {
                  return Json(simulation.in_world(group, frame).center.at(frame));
                })}};
  if (named.selects(group.targets))
    json["deformationRadius"] = channel_track(group.deformation_radius, frames);
  return json;
}

Json corners(const Box& box) { return {box.i0, box.i1, box.j0, box.j1}; }

}  // namespace

Json track(const FrameSpan& frames, const std::function<Json(int frame)>& value_at) {
  Json values = Json::array();
  bool is_constant = true;
  for (int frame = frames.first; frame <= frames.last; ++frame) {
    values.push_back(value_at(frame));
    is_constant = is_constant && values.back() == values.front();
  }
  if (is_constant) return Json::array({values.front()});
  return values;
}

Json track(const FrameSpan& frames, const ValueAt& value_at) {
  return track(frames, [&](int frame) { return to_json(value_at(frame)); });
}

Result<Json> view_forces(const Simulation& simulation, const FrameSpan& frames,
                         const StopRequest& should_stop) {
  const Scene& scene = simulation.scene();
  const Named named(scene);
  Json forces = Json::array();
  for (const Force& force : scene.forces) {
    if (is_stopped(should_stop)) return interrupted();
    forces.push_back(force_json(simulation, named, force, frames));
  }
  for (const Group& group : scene.groups) {
    if (is_stopped(should_stop)) return interrupted();
    forces.push_back(group_json(simulation, named, group, frames));
  }
  return forces;
}

SurfaceMarks::SurfaceMarks(const RestShape& shape) {
  if (!shape.grid || shape.weights) mesh_.emplace(shape);
}

void SurfaceMarks::add(int frame, const SurfaceReport& report,
                       const std::map<std::string, std::size_t, std::less<>>& force_numbers) {
  Json regions = Json::array(), forces = Json::array();
  for (const Region& region : report.regions) {
    regions.push_back({{"solved", region.is_solved()}});
    if (mesh_) {
      regions.back()["lines"] = lines_.add(mesh_->around(region.parts));
      continue;
    }
    Json parts = Json::array();
    for (const Box& part : region.parts) parts.push_back(corners(part));
    regions.back()["parts"] = parts;
  }
  for (const PatchOutline& patch : report.outlines) {
    if (patch.lines.segments.empty()) continue;
    regions.push_back(
        {{"solved", patch.is_solved}, {"lines", lines_.add(mesh_->to_vertices(patch.lines))}});
  }
  for (const ForceReport& force : report.forces) {
    if (force.kind == "group") continue;
    Json mark = {{"force", force_numbers.find(force.name)->second}};
    if (const Box& box = force.selection.force; !box.is_empty()) {
      if (mesh_) {
        mark["lines"] = lines_.add(mesh_->around({&box, 1}));
      } else {
        mark["box"] = corners(box);
      }
    } else if (!force.outline.segments.empty()) {
      mark["lines"] = lines_.add(mesh_->to_vertices(force.outline));
    } else if (force.kind != "inertia" || force.push.node_count == 0) {
      continue;
    }
    const auto& push = force.push.sum;
    if (force.kind == "inertia") mark["push"] = {push.x(), push.y(), push.z()};
    forces.push_back(std::move(mark));
  }
  Json marks = {{"regions", regions}, {"forces", forces}};
  if (marks == last_) return;
  last_ = marks;
  marks["frame"] = frame;
  changes_.push_back(std::move(marks));
}

}  // namespace pliant::viewer
