#pragma once

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

/// Runs steps. solve(w, v) has the displacement after a step of backward Euler of
/// steps.solved_length(), as Result<Field>; its first rows are the unknowns. Asks the context
/// before every step. watch(w) is told the displacement after each; if it returns false, the steps
/// end. Errors: those of `solve`; Interrupted. Internal to plate.
template <class Solve, class Watch>
Result<void> run_steps(const RunContext& context, const TimeSteps& steps, Motion& motion,
                       const Solve& solve, const Watch& watch) {
  Field& w = motion.displacement;
  Field& v = motion.velocity;
  const double dt = steps.solved_length();
  for (int step = 0; step < steps.count; ++step) {
    if (context.is_stopped()) return interrupted();
    auto next = solve(std::as_const(w), std::as_const(v));
    if (!next) return fail(next.error());
    const auto moved = next->topRows(w.rows());
    if (steps.are_reflected()) {
      v = 2 * (moved - w) / dt - v;
      w = 2 * moved - w;
    } else {
      v = (moved - w) / dt;
      w = moved;
    }
    if (!watch(std::as_const(w))) break;
  }
  return {};
}

template <class Solve>
Result<void> run_steps(const RunContext& context, const TimeSteps& steps, Motion& motion,
                       const Solve& solve) {
  return run_steps(context, steps, motion, solve, [](const Field&) { return true; });
}

/// The state of a problem after steps of its interior nodes, which its watch is told of.
template <class Solve>
Result<PlateState> run_steps(const RunContext& context, const TimeSteps& steps,
                             const PlateProblem& problem, PlateState state, const Solve& solve) {
  const Outline& outline = problem.outline;
  Motion motion{interior_of(outline, state.displacement), interior_of(outline, state.velocity)};
  const auto watch = [&](const Field& w) {
    return !problem.watch || (*problem.watch)(with_interior(outline, state.displacement, w));
  };
  if (auto done = run_steps(context, steps, motion, solve, watch); !done) return fail(done.error());
  return with_interior(problem, std::move(state), motion.displacement, motion.velocity);
}

}  // namespace pliant
