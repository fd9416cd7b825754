#pragma once

#include <cstddef>
#include <vector>

#include "pliant/scene/scene.hpp"

namespace pliant {

// Who acts on whom, looked up by name once for a scene; not for other rooms.

/// What may act on one surface, in the order of the scene and whether enabled or not.
struct SurfaceTargets {
  struct Member {
    std::size_t force = 0;  ///< index in the scene
    int group = -1;         ///< index in `groups` of the group that it is in; -1: none
  };
  std::vector<Member> forces = {};
  std::vector<std::size_t> groups = {};  ///< indices in the scene
};

/// One for each surface. Cost: once over all targets, and what comes out.
std::vector<SurfaceTargets> targets_of(const Scene& scene);

}  // namespace pliant
