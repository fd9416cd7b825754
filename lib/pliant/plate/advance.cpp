#include "pliant/plate/advance.hpp"

#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/core/stage_timer.hpp"
#include "pliant/plate/rim_load.hpp"
#include "pliant/plate/step_loop.hpp"

namespace pliant {

Result<PlateState> advance_in_steps(PlateSolver& solver, const PlateProblem& problem,
                                    const TimeSteps& steps, PlateState state) {
  const RunContext& context = solver.context();
  const Outline& outline = problem.outline;
  PLIANT_EXPECTS(is_on_nodes(problem, state) && !steps.are_exact());

  const double dt = steps.solved_length();
  const double inertia = problem.dynamics.inertia(dt);
  const double shift = problem.dynamics.shift(dt);
  StageTimer set_up(context.profile, Stage::SetUp);
  if (auto factored = solver.prepare(problem.system(dt)); !factored) {
    return fail(factored.error());
  }
  set_up.stop();
  const StageTimer solve(context.profile, Stage::Solve);

  Field load = problem.load;
  subtract_rim(outline, problem.stiffness, problem.tangents, state.displacement, load);
  const Field known = interior_of(outline, load);

  return with_motion(problem, steps, std::move(state),
                     [&](Motion& motion, const StepFilter& accepts) {
                       return run_steps(
                           context, steps, motion,
                           [&](const Field& w, const Field& v) {
                             return solver.solve(known + shift * w + inertia * v);
                           },
                           accepts);
                     });
}

}  // namespace pliant
