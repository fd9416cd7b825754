#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/core/stage_timer.hpp"
#include "pliant/plate/load_copy.hpp"
#include "pliant/plate/rim_load.hpp"
#include "pliant/plate/solver_errors.hpp"
#include "pliant/plate/solver_factories.hpp"
#include "pliant/plate/spectral/spectral_plate.hpp"

namespace pliant {
namespace {

class SpectralSolver final : public PlateSolver {
 public:
  explicit SpectralSolver(const RunContext& context)
      : PlateSolver(context), plate_(context), load_(context.memory) {}

  Result<void> prepare(const PlateSystem& system) override {
    grid_ = system.outline.grid();
    return plate_.prepare(system);
  }

  // With a transform to sine space and back.
  Result<Field> solve(const Field& right_hand_sides) override {
    PLIANT_EXPECTS(right_hand_sides.rows() == unknown_count(grid_));
    Field solution(right_hand_sides.rows(), 3);
    const long width = grid_.columns - 2;
    plate_.solve({right_hand_sides.data(), width, right_hand_sides.rows()},
                 {solution.data(), width, solution.rows()});
    return solution;
  }

  // Keeps the state in sine space for all steps.
  Result<PlateState> advance(const PlateProblem& problem, const TimeSteps& steps,
                             PlateState state) override try {
    const Grid& grid = problem.outline.grid();
    PLIANT_EXPECTS(is_on_nodes(problem, state));
    // In sine space reflected steps find v from (rho/h) v + (rho/h^2 + eta/h) w: digits would be
    // lost.
    const bool is_overdamped =
        problem.dynamics.damping * steps.solved_length() > 100 * problem.dynamics.density;
    if (steps.are_reflected() && is_overdamped) {
      return PlateSolver::advance(problem, steps, std::move(state));
    }
    const double inertia = problem.dynamics.inertia(steps.solved_length());
    const double shift = problem.dynamics.shift(steps.solved_length());
    StageTimer set_up(context().profile, Stage::SetUp);
    if (auto prepared = prepare({problem.outline, problem.stiffness, shift}); !prepared) {
      return fail(prepared.error());
    }
    set_up.stop();
    const StageTimer solve(context().profile, Stage::Solve);
    if (auto taken = load_.take(problem); !taken) return fail(taken.error());
    subtract_rim(problem.outline, problem.stiffness, problem.tangents, state.displacement,
                 load_.nodes());

    const long first = grid.node(1, 1);
    const long count = grid.node_count();
    const bool is_done =
        plate_.advance({load_.nodes().data() + first, grid.columns, count}, inertia, steps,
                       {state.displacement.data() + first, grid.columns, count},
                       {state.velocity.data() + first, grid.columns, count});
    if (!is_done) return fail(ErrorCode::Interrupted, "interrupted");
    clear_rim(problem.outline, state.velocity);
    return state;
  } catch (const std::bad_alloc&) {
    return fail(no_memory_to_solve(problem.outline.unknown_count(), "does not fit in memory"));
  }

  SolverCounts counts() const override { return plate_.counts(); }
  std::size_t memory() const override { return plate_.memory() + load_.memory(); }

 private:
  SpectralPlate plate_;
  LoadCopy load_;
  Grid grid_;  // of the last system
};

}  // namespace

std::unique_ptr<PlateSolver> make_spectral_solver(const RunContext& context) {
  return std::make_unique<SpectralSolver>(context);
}

}  // namespace pliant
