#include <optional>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/core/stage_timer.hpp"
#include "pliant/plate/load_copy.hpp"
#include "pliant/plate/rim_load.hpp"
#include "pliant/plate/solver_factories.hpp"
#include "pliant/plate/spectral_plate.hpp"

namespace pliant {
namespace {

// Solves one right-hand side after the other, each with its own transform to sine space and back.
class SpectralLinearSolver final : public LinearSolver {
 public:
  explicit SpectralLinearSolver(MemoryBudget* budget) : plate_(budget) {}

  Result<void> factor(const PlateSystem& system) override {
    auto prepared = plate_.prepare(system);
    system_.reset();
    if (prepared) system_ = system;
    return prepared;
  }

  Result<Field> solve(const Field& right_hand_sides) override {
    PLIANT_EXPECTS(system_ && right_hand_sides.rows() == unknown_count(system_->outline));
    Field solution(right_hand_sides.rows(), 3);
    const long width = system_->outline.grid().columns - 2;
    plate_.solve({right_hand_sides.data(), width, right_hand_sides.rows()},
                 {solution.data(), width, solution.rows()});
    return solution;
  }

  SolverCounts counts() const override { return plate_.counts(); }
  std::size_t memory() const override { return plate_.memory(); }

 private:
  SpectralPlate plate_;
  std::optional<PlateSystem> system_;
};

// Keeps the state in sine space for all steps of an interval.
class SpectralPlateSolver final : public PlateSolver {
 public:
  SpectralPlateSolver(MemoryBudget* budget, ThreadPool* threads, int most_lanes)
      : plate_(budget, threads, kernels_of_width(most_lanes)), load_(budget) {}

  Result<PlateState> advance(const PlateProblem& problem, const TimeSteps& steps, PlateState state,
                             const StopRequest& should_stop) override try {
    const Grid& grid = problem.outline.grid();
    PLIANT_EXPECTS(is_on_nodes(problem, state));
    const double inertia = problem.dynamics.density / steps.length;
    const double shift = (inertia + problem.dynamics.damping) / steps.length;
    StageTimer set_up(problem.profile, Stage::SetUp);
    if (auto prepared = plate_.prepare({problem.outline, problem.stiffness, shift}); !prepared) {
      return fail(prepared.error());
    }
    set_up.stop();
    const StageTimer solve(problem.profile, Stage::Solve);
    if (auto taken = load_.take(problem); !taken) return fail(taken.error());
    subtract_rim(problem.outline, problem.stiffness, problem.tangents, state.displacement,
                 load_.nodes());

    const long first = grid.node(1, 1);
    const long count = grid.node_count();
    const bool is_done =
        plate_.advance({load_.nodes().data() + first, grid.columns, count}, inertia, steps,
                       {state.displacement.data() + first, grid.columns, count},
                       {state.velocity.data() + first, grid.columns, count}, should_stop);
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
};

}  // namespace

std::unique_ptr<LinearSolver> make_spectral_solver(MemoryBudget* budget) {
  return std::make_unique<SpectralLinearSolver>(budget);
}

std::unique_ptr<PlateSolver> make_spectral_plate_solver(MemoryBudget* budget, ThreadPool* threads,
                                                        int most_lanes) {
  return std::make_unique<SpectralPlateSolver>(budget, threads, most_lanes);
}

}  // namespace pliant
