#pragma once

#include <cstdint>
#include <vector>

#include "pliant/body/step_report.hpp"
#include "pliant/plate/plate_solver.hpp"
#include "pliant/plate/solver_cache.hpp"
#include "pliant/region/region.hpp"

namespace pliant {

/// Workspace of a body, kept from frame to frame; not part of the state. Fields keep their memory
/// while the regions keep their shape. Internal to body.
struct BodyWorkspace {
  /// A patch and its problem during the solve.
  struct PatchSolve {
    const Patch* patch = nullptr;
    double settling_length = 0;  ///< with `Release::Recover` [length]
    PlateProblem problem;
    PlateState plate;
  };

  Selection selection;   ///< of the forces alone, at the last frame
  StepReport report;     ///< of the last frame
  NodeTiles tiles;       ///< of the nodes that forces measure
  NodeTiles rest_tiles;  ///< of the nodes at rest, if needed
  std::vector<std::uint8_t> marks;
  std::vector<Outline> outlines;   ///< of the solvers that exist, one for each patch
  std::vector<PatchSolve> solves;  ///< one for each patch, in the order of the regions
  Field next_positions;            ///< the next state, until it is complete
  Field next_velocities;
};

}  // namespace pliant
