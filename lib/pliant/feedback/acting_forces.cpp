#include "pliant/feedback/acting_forces.hpp"

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>
#include <variant>

#include "pliant/sampling/rest_shape.hpp"
#include "pliant/scene/format/description.hpp"

namespace pliant {
namespace {

// Whether a force of magnitude 1 changes between frames, on a surface that does not move.
struct Changes {
  template <class Kind>
  bool operator()(const Kind& kind) const {
    bool any = false;
    for_each_channel(kind, [&](const std::string&, const Attribute&, const auto& channel) {
      any = any || channel.is_animated();
    });
    return any;
  }
  bool operator()(const NoiseChannels& noise) const {
    return noise.rate.at(0)[0] != 0 || operator()<NoiseChannels>(noise);
  }
  bool operator()(const CustomForce&) const { return true; }
};

bool moves(const Surface& surface) {
  const auto& [translate, rotate, scale, order] = surface.transform;
  return surface.is_animated() || translate.is_animated() || rotate.is_animated() ||
         scale.is_animated();
}

bool changes(const Surface& surface) {
  const MaterialChannels& material = surface.material;
  return moves(surface) || material.b.is_animated() || material.c.is_animated() ||
         material.d.is_animated();
}

// What carries the forces on a shape. Most scenes follow nothing, and have very many forces.
std::shared_ptr<const Carriers> carriers_of(const Scene& scene, const RestShape* shape) {
  static const auto nothing = std::make_shared<const Carriers>(Scene());
  if (!shape) return std::make_shared<const Carriers>(scene);
  return shape->carriers ? shape->carriers : nothing;
}

// Whether what a force or group follows moves.
template <class Follower>
bool is_carried(const Scene& scene, const Follower& follower) {
  return !follower.follow.empty() &&
         std::ranges::any_of(scene.surfaces, [&](const Surface& surface) {
           return surface.name == follower.follow && moves(surface);
         });
}

bool changes(const Scene& scene, const Force& force) {
  return force.deformation_radius.is_animated() || force.force_radius.is_animated() ||
         std::visit(Changes{}, force.kind) || is_carried(scene, force);
}

bool changes(const Scene& scene, const Group& group) {
  return group.center.is_animated() || group.deformation_radius.is_animated() ||
         is_carried(scene, group);
}

}  // namespace

ActingForces::ActingForces(const Scene& scene, const Surface& surface,
                           std::vector<std::size_t> forces, const std::vector<std::size_t>& groups,
                           const RestShape* shape)
    : scene_(scene),
      surface_(surface),
      forces_(std::move(forces)),
      animation_(shape ? shape->animation : nullptr),
      carriers_(carriers_of(scene, shape)) {
  std::map<std::string_view, const Group*> named;
  for (const std::size_t group : groups)
    named.emplace(scene.groups[group].name, &scene.groups[group]);
  for (const std::size_t force : forces_) {
    const auto found = named.find(scene.forces[force].group);
    group_of_.push_back(found != named.end() ? found->second : nullptr);
    clocks_.push_back(clock_of(scene.forces[force], scene.start));
  }
  for (const std::size_t group : groups) groups_.push_back(&scene.groups[group]);
}

BodyInputs ActingForces::at(int frame, const std::shared_ptr<ForceFaults>& faults) const {
  const ShapeFrames shape = sample_shape(animation_.get(), frame, *faults);
  BodyInputs inputs = sample_body(scene_, surface_, frame, shape);
  std::vector<const Group*> selecting;  // one for each enabled force
  for (std::size_t k = 0; k < forces_.size(); ++k) {
    const Force& force = scene_.forces[forces_[k]];
    if (!pliant::is_enabled(force, group_of_[k], frame)) continue;
    inputs.forces.push_back(
        sample_force(scene_, force, surface_, frame, faults, *carriers_, clocks_[k].get(), shape));
    inputs.selectors.push_back(static_cast<int>(inputs.selectors.size()));
    selecting.push_back(group_of_[k]);
  }
  if (surface_.solver.region == SolvedRegion::All) return inputs;
  std::map<const Group*, int> selectors;
  for (const Group* const group : groups_) {
    if (!group->enabled.at(frame)) continue;
    const auto selector = static_cast<int>(inputs.forces.size());
    selectors.emplace(group, selector);
    inputs.forces.push_back(sample_group(scene_, *group, frame, *faults, *carriers_));
    inputs.selectors.push_back(selector);
  }
  for (std::size_t k = 0; k < selecting.size(); ++k) {
    const auto selector = selectors.find(selecting[k]);
    if (selector != selectors.end()) inputs.selectors[k] = selector->second;
  }
  return inputs;
}

std::vector<std::size_t> ActingForces::enabled_at(int frame) const {
  std::vector<std::size_t> enabled;
  for (std::size_t k = 0; k < forces_.size(); ++k) {
    if (pliant::is_enabled(scene_.forces[forces_[k]], group_of_[k], frame)) {
      enabled.push_back(forces_[k]);
    }
  }
  return enabled;
}

std::vector<std::size_t> ActingForces::groups_at(int frame) const {
  std::vector<std::size_t> selecting;
  for (const Group* const group : groups_) {
    if (group->enabled.at(frame))
      selecting.push_back(static_cast<std::size_t>(group - scene_.groups.data()));
  }
  return selecting;
}

bool ActingForces::is_enabled(std::size_t force, int frame) const {
  const auto place = std::lower_bound(forces_.begin(), forces_.end(), force) - forces_.begin();
  return pliant::is_enabled(scene_.forces[force], group_of_[static_cast<std::size_t>(place)],
                            frame);
}

bool ActingForces::selects_at(int frame) const {
  if (surface_.solver.region == SolvedRegion::All) return true;
  for (std::size_t k = 0; k < forces_.size(); ++k) {
    if (pliant::is_enabled(scene_.forces[forces_[k]], group_of_[k], frame)) return true;
  }
  return std::any_of(groups_.begin(), groups_.end(),
                     [&](const Group* group) { return group->enabled.at(frame); });
}

bool ActingForces::stand_still() const {
  return !changes(surface_) && std::none_of(forces_.begin(), forces_.end(), [&](std::size_t force) {
    return changes(scene_, scene_.forces[force]);
  }) && std::none_of(groups_.begin(), groups_.end(), [&](const Group* group) {
    return changes(scene_, *group);
  });
}

}  // namespace pliant
