#include "pliant/plate/plate_solver.hpp"

#include <algorithm>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/plate/solver_factories.hpp"

namespace pliant {
namespace {

// Steps with a factored matrix.
class DirectPlateSolver final : public PlateSolver {
 public:
  explicit DirectPlateSolver(std::unique_ptr<LinearSolver> solver) : solver_(std::move(solver)) {}

  Result<PlateState> advance(const PlateProblem& problem, const TimeSteps& steps, PlateState state,
                             const StopRequest& should_stop) override {
    return advance_backward_euler(*solver_, problem, steps, std::move(state), should_stop);
  }

  SolverCounts counts() const override { return solver_->counts(); }
  std::size_t memory() const override { return solver_->memory(); }

 private:
  std::unique_ptr<LinearSolver> solver_;
};

// Takes the solver that suits each problem, and lets the other one go.
class AutomaticPlateSolver final : public PlateSolver {
 public:
  AutomaticPlateSolver(bool prefers_spectral, MemoryBudget* budget, ThreadPool* threads)
      : prefers_spectral_(prefers_spectral), budget_(budget), threads_(threads) {}

  Result<PlateState> advance(const PlateProblem& problem, const TimeSteps& steps, PlateState state,
                             const StopRequest& should_stop) override {
    const bool is_rectangle = problem.interior.empty();
    const bool is_spectral = is_rectangle && (prefers_spectral_ ||
                                              worth_transforming(problem.grid, problem.stiffness));
    if (!solver_ || is_spectral != is_spectral_) {
      past_counts_ = counts();
      solver_.reset();
      is_spectral_ = is_spectral;
      solver_ = is_spectral ? make_spectral_plate_solver(budget_, threads_)
                            : std::make_unique<DirectPlateSolver>(
                                  make_solver(available_solvers().front(), budget_));
    }
    return solver_->advance(problem, steps, std::move(state), should_stop);
  }

  SolverCounts counts() const override {
    if (!solver_) return past_counts_;
    const SolverCounts now = solver_->counts();
    return {past_counts_.analyses + now.analyses, past_counts_.factorizations + now.factorizations,
            past_counts_.solves + now.solves};
  }

  std::size_t memory() const override { return solver_ ? solver_->memory() : 0; }

 private:
  bool prefers_spectral_;
  MemoryBudget* budget_;
  ThreadPool* threads_;
  std::unique_ptr<PlateSolver> solver_;
  bool is_spectral_ = false;
  SolverCounts past_counts_;  // of solvers that were let go
};

SolverKind kind_of(SolverChoice choice) {
  return choice == SolverChoice::Cholmod ? SolverKind::Cholmod : SolverKind::Eigen;
}

}  // namespace

std::optional<SolverChoice> solver_choice(std::string_view name) {
  if (name == "auto") return SolverChoice::Auto;
  if (name == "spectral") return SolverChoice::Spectral;
  if (name == "cholmod") return SolverChoice::Cholmod;
  if (name == "eigen") return SolverChoice::Eigen;
  return {};
}

bool is_available(SolverChoice choice) {
  const auto kinds = available_solvers();
  return choice != SolverChoice::Cholmod ||
         std::find(kinds.begin(), kinds.end(), SolverKind::Cholmod) != kinds.end();
}

bool worth_transforming(const Grid& grid, const Stiffness& stiffness) {
  // Measured, 20 steps: 9 x 9 nodes take 17 us in sine space and 22 by CHOLMOD, 5 x 100 as long by
  // either, 3 x 300 298 and 102 us, since rows of vectors are hardly filled.
  constexpr int shortest_side = 9;
  // By so much c may come closer to its bound than to 0, and the solution loses as many digits.
  constexpr double closest = 1e-3;
  return std::min(grid.columns, grid.rows) >= shortest_side &&
         stiffness.c - stiffness.least_c() >= -closest * stiffness.least_c();
}

std::unique_ptr<PlateSolver> make_plate_solver(SolverChoice choice, MemoryBudget* budget,
                                               ThreadPool* threads) {
  PLIANT_EXPECTS(is_available(choice));
  if (choice == SolverChoice::Auto || choice == SolverChoice::Spectral) {
    return std::make_unique<AutomaticPlateSolver>(choice == SolverChoice::Spectral, budget, threads);
  }
  return std::make_unique<DirectPlateSolver>(make_solver(kind_of(choice), budget));
}

}  // namespace pliant
