#include "pliant/plate/advance.hpp"

#include "pliant/core/expects.hpp"
#include "pliant/core/stage_timer.hpp"
#include "pliant/plate/rim_load.hpp"

namespace pliant {

Result<PlateState> advance_in_steps(PlateSolver& solver, const PlateProblem& problem,
                                    const TimeSteps& steps, PlateState state) {
  const RunContext& context = solver.context();
  const Outline& outline = problem.outline;
  PLIANT_EXPECTS(is_on_nodes(problem, state));

  const double dt = steps.solved_length();
  const double inertia = problem.dynamics.inertia(dt);
  const double shift = problem.dynamics.shift(dt);
  StageTimer set_up(context.profile, Stage::SetUp);
  if (auto factored = solver.prepare({outline, problem.stiffness, shift}); !factored) {
    return fail(factored.error());
  }
  set_up.stop();
  const StageTimer solve(context.profile, Stage::Solve);

  Field w = interior_of(outline, state.displacement);
  Field v = interior_of(outline, state.velocity);
  Field load = problem.load;
  subtract_rim(outline, problem.stiffness, problem.tangents, state.displacement, load);
  const Field known = interior_of(outline, load);

  for (int step = 0; step < steps.count; ++step) {
    if (context.is_stopped()) return fail(ErrorCode::Interrupted, "interrupted");
    auto next = solver.solve(known + shift * w + inertia * v);
    if (!next) return fail(next.error());
    if (steps.are_reflected()) {
      v = 2 * (*next - w) / dt - v;
      w = 2 * *next - w;
    } else {
      v = (*next - w) / dt;
      w = *std::move(next);
    }
  }

  state.displacement = with_interior(outline, std::move(state.displacement), w);
  state.velocity = with_interior(outline, Field::Zero(problem.load.rows(), 3), v);
  return state;
}

}  // namespace pliant
