#pragma once

#include "pliant/core/profile.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/plate/linear_solver.hpp"
#include "pliant/plate/outline.hpp"
#include "pliant/plate/plate.hpp"
#include "pliant/plate/time_steps.hpp"

namespace pliant {

/// One plate over one interval: everything that stays the same while its steps run. SPEC 4.
struct PlateProblem {
  Outline outline;  ///< of at least 3 x 3 nodes
  Stiffness stiffness;
  Dynamics dynamics;
  EdgeTangents tangents;
  Field load;  ///< #nodes x 3; rim rows are not read [length/uv^4]

  /// Receives the time spent in set-up and solve; null: no profiling. Must outlive the call.
  Profile* profile = nullptr;
};

/// Whether the problem's load and the state have a row for each node.
inline bool is_on_nodes(const PlateProblem& problem, const PlateState& state) {
  const int nodes = problem.outline.grid().node_count();
  return problem.load.rows() == nodes && state.displacement.rows() == nodes &&
         state.velocity.rows() == nodes;
}

/// Advances a plate by backward Euler: in each step of length dt
///
///   (rho/dt^2 + eta/dt) w' + L w' = F + (rho/dt^2 + eta/dt) w + (rho/dt) v,   v' = (w' - w)/dt (8)
///
/// The rim keeps its displacement, with velocity 0 after the first step. With rho = eta = 0 each
/// step gives the static solution. First order in dt, stable for every dt. `should_stop` is called
/// before every step. Requires: state fields are #nodes x 3. Errors: those of the solver;
/// Interrupted if `should_stop` returns true.
Result<PlateState> advance_backward_euler(LinearSolver& solver, const PlateProblem& problem,
                                          const TimeSteps& steps, PlateState state,
                                          const StopRequest& should_stop = {});

}  // namespace pliant
