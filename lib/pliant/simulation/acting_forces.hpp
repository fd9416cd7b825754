#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "pliant/simulation/sampling.hpp"

namespace pliant {

// Some of the forces of a scene and what they do to one surface as if there were no others; not for
// other rooms.
class ActingForces {
 public:
  /// Indices in the scene, ascending: of forces that target the surface, and of the groups that
  /// select on it. The scene outlives this.
  ActingForces(const Scene& scene, const Surface& surface, std::vector<std::size_t> forces,
               std::vector<std::size_t> groups);

  /// What acts at a frame, as `sample_inputs` has it with these forces and groups alone.
  BodyInputs at(int frame, const std::shared_ptr<ForceFaults>& faults) const;

  /// The forces among `at(frame).forces`, in their order; the regions of groups follow them.
  std::vector<std::size_t> enabled_at(int frame) const;

  bool is_enabled(std::size_t force, int frame) const;

  /// Whether any force is enabled, or any group.
  bool selects_at(int frame) const;

  /// Whether what they do from frame to frame differs by their magnitudes alone, while enabled.
  bool stand_still() const;

  const std::vector<std::size_t>& forces() const { return forces_; }

 private:
  const Scene& scene_;
  const Surface& surface_;
  std::vector<std::size_t> forces_;
  std::vector<const Group*> group_of_;  // of each force; null: none
  std::vector<const Group*> groups_;
  std::vector<std::unique_ptr<NoiseClock>> clocks_;  // of each force; null: it needs none
};

}  // namespace pliant
