#pragma once

#include <functional>
#include <utility>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/plate/plate_problem.hpp"
#include "pliant/plate/time_steps.hpp"

namespace pliant {

/// Unknowns that are stepped (#unknowns x 3).
struct Motion {
  Field displacement;
  Field velocity;
};

/// Asked with the solution of a step before it is gone; false: neither it nor those after it are.
/// Empty: all are.
using StepFilter = std::function<bool(const Field& solution)>;

/// Runs steps; how many were gone. solve(w, v) has the displacement after a step of backward Euler
/// of steps.solved_length(), as Result<Field>; its first rows are the unknowns. Asks the context
/// before every step. Errors: those of `solve`; Interrupted. Internal to plate.
template <class Solve>
Result<int> run_steps(const RunContext& context, const TimeSteps& steps, Motion& motion,
                      const Solve& solve, const StepFilter& accepts = {}) {
  Field& w = motion.displacement;
  Field& v = motion.velocity;
  const double dt = steps.solved_length();
  for (int step = 0; step < steps.count; ++step) {
    if (context.is_stopped()) return interrupted();
    auto next = solve(std::as_const(w), std::as_const(v));
    if (!next) return fail(next.error());
    if (accepts && !accepts(*next)) return step;
    const auto moved = next->topRows(w.rows());
    if (steps.are_reflected()) {
      v = 2 * (moved - w) / dt - v;
      w = 2 * moved - w;
    } else {
      v = (moved - w) / dt;
      w = moved;
    }
  }
  return steps.count;
}

/// The state of a problem after go(motion, accepts) has gone with its interior nodes, as
/// `run_steps` does; its watch is asked.
template <class Go>
Result<PlateState> with_motion(const PlateProblem& problem, const TimeSteps& steps,
                               PlateState state, const Go& go) {
  const Outline& outline = problem.outline;
  Motion motion{interior_of(outline, state.displacement), interior_of(outline, state.velocity)};
  StepFilter accepts;
  if (problem.watch) {
    accepts = [&](const Field& solution) {
      const Field& w = motion.displacement;
      return (*problem.watch)(with_interior(
          outline, state.displacement, steps.are_reflected() ? Field(2 * solution - w) : solution));
    };
  }
  const Result<int> gone = go(motion, accepts);
  if (!gone) return fail(gone.error());
  return with_interior(problem, std::move(state), motion.displacement, motion.velocity);
}

}  // namespace pliant
