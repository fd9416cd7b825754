#pragma once

#include <cstdint>
#include <vector>

#include "pliant/plate/plate_solver.hpp"
#include "pliant/plate/solver_cache.hpp"
#include "pliant/region/region.hpp"

namespace pliant {

/// What a body works in from frame to frame: nothing of it is state. Fields keep their memory while
/// the regions keep their shape. Not for other rooms.
struct BodyWorkspace {
  /// A patch on its way through its solver.
  struct PatchSolve {
    const Patch* patch = nullptr;
    double settling_length = 0;  ///< with `Release::Recover` [length]
    PlateProblem problem;
    PlateState plate;
  };

  NodeTiles tiles;       ///< of the nodes that forces measure
  NodeTiles rest_tiles;  ///< of the nodes at rest, where they are needed
  std::vector<std::uint8_t> marks;
  std::vector<SolverCache::Outline> outlines;  ///< that there are solvers for, of each patch
  std::vector<PatchSolve> solves;              ///< of each patch, in the order of the regions
  Field next_positions;  ///< the state that the frame makes, until it is whole
  Field next_velocities;
};

}  // namespace pliant
