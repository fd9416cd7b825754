#pragma once

#include <cstddef>
#include <vector>

#include "pliant/scene/scene.hpp"

namespace pliant {

// Which forces act on which surfaces, looked up by name once per scene; not for programs.

/// The forces, groups and colliders that target one surface, enabled or not, in the order of the
/// scene; none target one that is driven.
struct SurfaceTargets {
  struct Member {
    std::size_t force = 0;  ///< index in the scene
    int group = -1;         ///< index of its group in `groups`; -1: none
  };
  std::vector<Member> forces = {};
  std::vector<std::size_t> groups = {};     ///< indices in the scene
  std::vector<std::size_t> colliders = {};  ///< likewise

  /// The group of a member; null: none.
  const Group* group_of(const Member& member, const Scene& scene) const {
    return member.group < 0 ? nullptr
                            : &scene.groups[groups[static_cast<std::size_t>(member.group)]];
  }
};

/// One for each surface. Cost: linear in the number of targets and the size of the result.
std::vector<SurfaceTargets> targets_of(const Scene& scene);

}  // namespace pliant
