#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pliant/forces/force.hpp"
#include "pliant/plate/time_steps.hpp"
#include "pliant/region/selection.hpp"

namespace pliant {

/// A force, or the region of a group, that is enabled at a frame and targets the surface.
struct ForceReport {
  std::string name;       ///< of the force, or of the group whose region it is
  std::string_view kind;  ///< the scene's word for it: point, ..., group; "custom"
  /// Centre, radii, direction, magnitude at the frame; world space. A drawn falloff belongs to the
  /// simulation's scene.
  SampledForce sampled;
  ForceSelection selection;  ///< its boxes in nodes, and which region it acts in
  Push push;                 ///< what it gives to the nodes that move
};

/// What the solve at a frame takes and does, on one surface. SPEC 5, 6.
struct SurfaceReport {
  bool is_solved = false;              ///< otherwise the next frame is like this one
  TimeSteps steps;                     ///< of the solve
  int unknown_count = 0;               ///< nodes that move
  int recovering = 0;                  ///< nodes solved because they are not back at rest
  int settled = 0;                     ///< nodes put at rest ahead of the solve
  std::vector<Region> regions;         ///< also those too small to solve
  std::vector<bool> region_is_solved;  ///< for each of them
  std::vector<ForceReport> forces;     ///< in the order of the scene, then those of groups
};

/// What the solve at one frame, which makes the next frame's mesh, takes from this frame's.
struct FrameReport {
  int frame = 0;
  std::vector<SurfaceReport> surfaces;  ///< in the order of the scene
};

}  // namespace pliant
