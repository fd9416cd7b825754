#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "pliant/sampling/sampling.hpp"

namespace pliant {

// Some forces of a scene, and their effect on one surface without the other forces; not for other
// rooms.
class ActingForces {
 public:
  /// Indices in the scene, ascending, of forces that target the surface and of groups that select
  /// on it. Requires: the scene outlives this.
  /// `shape`: the surface's rest shape; null: it stands still, and nothing follows a cache.
  ActingForces(const Scene& scene, const Surface& surface, std::vector<std::size_t> forces,
               const std::vector<std::size_t>& groups, const RestShape* shape = nullptr);

  /// The inputs at a frame, as `sample_inputs` would return them with only these forces and groups.
  BodyInputs at(int frame, const std::shared_ptr<ForceFaults>& faults) const;

  /// The forces among `at(frame).forces`, in their order; the regions of groups follow them.
  std::vector<std::size_t> enabled_at(int frame) const;

  /// The groups that select at a frame, by their index in the scene.
  std::vector<std::size_t> groups_at(int frame) const;

  bool is_enabled(std::size_t force, int frame) const;

  /// Whether any force or group is enabled.
  bool selects_at(int frame) const;

  /// Whether, while enabled, only magnitudes change between frames.
  bool stand_still() const;

  /// Whether its effect is that of `other` with the same scene and surface.
  bool acts_as(const ActingForces& other) const {
    return forces_ == other.forces_ && groups_ == other.groups_;
  }

  const std::vector<std::size_t>& forces() const { return forces_; }

 private:
  const Scene& scene_;
  const Surface& surface_;
  std::vector<std::size_t> forces_;
  std::vector<const Group*> group_of_;  // of each force; null: no group
  std::vector<const Group*> groups_;
  std::vector<std::unique_ptr<NoiseClock>> clocks_;  // of each force; null: not needed
  std::shared_ptr<const AnimatedShape> animation_;
  std::shared_ptr<const Carriers> carriers_;
};

}  // namespace pliant
