#include "pliant/plate/backward_euler.hpp"

#include "pliant/core/expects.hpp"
#include "pliant/core/stage_timer.hpp"
#include "pliant/plate/domain.hpp"

namespace pliant {

Result<PlateState> advance_backward_euler(LinearSolver& solver, const PlateProblem& problem,
                                          const TimeSteps& steps, PlateState state,
                                          const StopRequest& should_stop) {
  const Grid& grid = problem.grid;
  const InteriorMask& mask = problem.interior;
  PLIANT_EXPECTS(is_on_nodes(problem, state));

  const double dt = steps.length;
  const double inertia = problem.dynamics.density / dt;            // factor of v
  const double shift = (inertia + problem.dynamics.damping) / dt;  // factor of w
  StageTimer set_up(problem.profile, Stage::SetUp);
  if (auto factored = solver.factor({grid, problem.stiffness, shift, mask}); !factored) {
    return fail(factored.error());
  }
  set_up.stop();
  const StageTimer solve(problem.profile, Stage::Solve);

  // The contribution of the rim and the tangents is L of the field that equals w on the rim and is
  // 0 inside; it is known, so it becomes part of the load.
  Field w = interior_of(grid, mask, state.displacement);
  Field v = interior_of(grid, mask, state.velocity);
  const Field zero = Field::Zero(w.rows(), 3);
  const Field rim = with_interior(grid, mask, state.displacement, zero);
  const Field known = interior_of(grid, mask, problem.load) -
                      apply_stencil(grid, mask, problem.stiffness, problem.tangents, rim);

  for (int step = 0; step < steps.count; ++step) {
    if (should_stop && should_stop()) return fail(ErrorCode::Interrupted, "interrupted");
    auto next = solver.solve(known + shift * w + inertia * v);
    if (!next) return fail(next.error());
    v = (*next - w) / dt;
    w = *std::move(next);
  }

  state.displacement = with_interior(grid, mask, std::move(state.displacement), w);
  state.velocity = with_interior(grid, mask, Field::Zero(grid.node_count(), 3), v);
  return state;
}

}  // namespace pliant
