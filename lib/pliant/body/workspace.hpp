#pragma once

#include <cstdint>
#include <vector>

#include "pliant/body/state.hpp"
#include "pliant/body/step_plan.hpp"
#include "pliant/plate/plate_problem.hpp"
#include "pliant/region/node_tiles.hpp"

namespace pliant {

/// A patch while it is solved: what the solver is given, and its answer. Internal to body.
struct PatchSolve {
  const Patch* patch = nullptr;
  Box box = {};                ///< that of the problem's factors; empty: of none yet
  double settling_length = 0;  ///< with `Release::Recover` [length]
  PlateProblem problem;
  PlateState plate;
};

/// What a body keeps from frame to frame besides its state: the last plan, and memory for the next
/// step, which fields keep while the regions keep their shape. Internal to body.
struct BodyWorkspace {
  StepPlan plan;
  NodeTiles tiles;       ///< of the nodes that forces measure
  Field measured;        ///< these nodes, if the rest shape is animated
  NodeTiles rest_tiles;  ///< of the nodes at rest, if needed
  std::vector<std::uint8_t> marks;
  std::vector<PatchSolve> solves;  ///< one for each patch and solver, in the order of the regions
  Field next_positions;            ///< the next state, until it is complete
  Field next_velocities;
  LastPush next_push;         ///< only if the body remembers it
  PlasticField next_plastic;  ///< only if it yields
};

}  // namespace pliant
