#include "pliant/plate/plate_solver.hpp"

#include <algorithm>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/plate/advance.hpp"
#include "pliant/plate/rim_load.hpp"
#include "pliant/plate/solver_factories.hpp"

namespace pliant {
namespace {

// Creates the solver that suits each problem, and destroys the previous one if it was of another
// kind.
class AutomaticPlateSolver final : public PlateSolver {
 public:
  AutomaticPlateSolver(SolverChoice choice, const RunContext& context)
      : PlateSolver(context), choice_(choice) {}

  Result<void> prepare(const PlateSystem& system) override {
    return suited(system.outline, system.stiffness, system.is_even()).prepare(system);
  }

  Result<Field> solve(const Field& right_hand_sides) override {
    PLIANT_EXPECTS(solver_ != nullptr);
    return solver_->solve(right_hand_sides);
  }

  Result<PlateState> advance(const PlateProblem& problem, const TimeSteps& steps,
                             PlateState state) override {
    PlateSolver& solver =
        suited(problem.outline, problem.stiffness, problem.is_even(), steps.are_exact());
    if (problem.law) return advance_plastic(solver, problem, steps, std::move(state));
    return solver.advance(problem, steps, std::move(state));
  }

  StepTerms terms(const PlateProblem& problem, double dt, const Field& displacement) override {
    PLIANT_EXPECTS(solver_ != nullptr);
    return solver_->terms(problem, dt, displacement);
  }

  SolverCounts counts() const override {
    return solver_ ? past_counts_ + solver_->counts() : past_counts_;
  }

  std::size_t memory() const override { return solver_ ? solver_->memory() : 0; }

 private:
  enum class Way { Spectral, Direct, Energy };

  PlateSolver& suited(const Outline& outline, const Stiffness& stiffness, bool is_even,
                      bool is_exact = false) {
    const Way way = is_even ? way_of(outline, stiffness, is_exact) : Way::Energy;
    if (!solver_ || way != way_) {
      past_counts_ = counts();
      solver_.reset();
      way_ = way;
      solver_ = make(way);
    }
    return *solver_;
  }

  Way way_of(const Outline& outline, const Stiffness& stiffness, bool is_exact) {
    // Sparse factors of the stencil have clamped edges only.
    const Way factored = outline.edges().are_clamped() ? Way::Direct : Way::Energy;
    if (!transforms() || outline.is_periodic()) return factored;
    // So have exact steps in sine space.
    if (is_exact && factored == Way::Energy) return factored;
    if (!outline.is_rectangle()) return Way::Direct;
    const bool is_worth_it =
        choice_ == SolverChoice::Spectral || worth_transforming(outline.grid(), stiffness);
    return is_worth_it ? Way::Spectral : factored;
  }

  std::unique_ptr<PlateSolver> make(Way way) const {
    switch (way) {
      case Way::Spectral:
        return make_spectral_solver(context());
      case Way::Energy:
        return make_energy_solver(factor(), context());
      default:
        return make_sparse_solver(factor(), context());
    }
  }

  bool transforms() const {
    return choice_ == SolverChoice::Auto || choice_ == SolverChoice::Spectral;
  }
  SolverChoice factor() const { return transforms() ? available_solvers().front() : choice_; }

  SolverChoice choice_;
  std::unique_ptr<PlateSolver> solver_;
  Way way_ = Way::Direct;
  SolverCounts past_counts_;  // of the solvers that were destroyed
};

}  // namespace

Result<PlateState> PlateSolver::advance(const PlateProblem& problem, const TimeSteps& steps,
                                        PlateState state) {
  return advance_in_steps(*this, problem, steps, std::move(state));
}

Result<void> PlateSolver::solve_for(const std::vector<int>&, const Field& right_hand_sides,
                                    Field& solution) {
  auto solved = solve(right_hand_sides);
  if (!solved) return fail(solved.error());
  solution = *std::move(solved);
  return {};
}

StepTerms PlateSolver::terms(const PlateProblem& problem, double dt, const Field& displacement) {
  Field load = problem.load;
  subtract_rim(problem.outline, problem.stiffness, problem.tangents, displacement, load);
  const Eigen::Index count = problem.outline.unknown_count();
  return {interior_of(problem.outline, load),
          Eigen::VectorXd::Constant(count, problem.dynamics.shift(dt)),
          Eigen::VectorXd::Constant(count, problem.dynamics.inertia(dt))};
}

bool worth_transforming(const Grid& grid, const Stiffness& stiffness) {
  // Measured, 20 steps: 9 x 9 nodes need 17 us in sine space and 22 us by CHOLMOD, 5 x 100 the same
  // time by both, 3 x 300 298 and 102 us, since rows of vectors are almost empty.
  constexpr int shortest_side = 9;
  // How close c may be to its bound, relative to the bound; the solution loses as many digits.
  constexpr double closest = 1e-3;
  return std::min(grid.columns, grid.rows) >= shortest_side &&
         stiffness.c - stiffness.least_c() >= -closest * stiffness.least_c();
}

std::unique_ptr<PlateSolver> make_plate_solver(SolverChoice choice, const RunContext& context) {
  PLIANT_EXPECTS(is_available(choice));
  return std::make_unique<AutomaticPlateSolver>(choice, context);
}

}  // namespace pliant
