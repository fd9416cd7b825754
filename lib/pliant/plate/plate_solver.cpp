#include "pliant/plate/plate_solver.hpp"

#include <algorithm>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/plate/advance.hpp"
#include "pliant/plate/contact/advance_with_contact.hpp"
#include "pliant/plate/rim_load.hpp"
#include "pliant/plate/solver_factories.hpp"

namespace pliant {
namespace {

// Creates the solver that suits each problem, and destroys the previous one if it was of another
// kind.
class AutomaticPlateSolver final : public PlateSolver {
 public:
  AutomaticPlateSolver(SolverChoice choice, const RunContext& context)
      : PlateSolver(context), choice_(choice), contact_memory_(context) {}

  Result<void> prepare(const PlateSystem& system) override {
    return suited(system.outline, system.stiffness, system.is_even()).prepare(system);
  }

  Result<Field> solve(const Field& right_hand_sides) override {
    PLIANT_EXPECTS(solver_ != nullptr);
    return solver_->solve(right_hand_sides);
  }

  Result<Field> solve_roughly(const Field& right_hand_sides) override {
    PLIANT_EXPECTS(solver_ != nullptr);
    return solver_->solve_roughly(right_hand_sides);
  }

  Result<PlateState> advance(const PlateProblem& problem, const TimeSteps& steps,
                             PlateState state) override {
    PlateSolver& solver =
        suited(problem.outline, problem.stiffness, problem.is_even(), steps.are_exact());
    if (problem.contact) return meet(solver, problem, steps, std::move(state));
    if (problem.law) return advance_plastic(solver, problem, steps, std::move(state));
    return solver.advance(problem, steps, std::move(state));
  }

  StepTerms terms(const PlateProblem& problem, double dt, const Field& displacement) override {
    PLIANT_EXPECTS(solver_ != nullptr);
    return solver_->terms(problem, dt, displacement);
  }

  SolverCounts counts() const override {
    SolverCounts counts = past_counts_;
    if (solver_) counts = counts + solver_->counts();
    if (whole_) counts = counts + whole_->counts();
    return counts;
  }

  std::size_t memory() const override {
    return (solver_ ? solver_->memory() : 0) + (whole_ ? whole_->memory() : 0) +
           contact_memory_.columns.memory();
  }

 private:
  PlateSolver& suited(const Outline& outline, const Stiffness& stiffness, bool is_even,
                      bool is_exact = false) {
    const bool transforms = is_even && is_transformed(outline, stiffness, is_exact);
    if (!solver_ || transforms != transforms_) {
      past_counts_ = counts();
      solver_.reset();
      whole_.reset();
      contact_memory_.forget();
      transforms_ = transforms;
      solver_ =
          transforms ? make_spectral_solver(context()) : make_sparse_solver(factor(), context());
    }
    return *solver_;
  }

  // Newmark's steps need two systems: of half a step, and of a whole one where something touches.
  Result<PlateState> meet(PlateSolver& solver, const PlateProblem& problem, const TimeSteps& steps,
                          PlateState state) {
    if (steps.are_reflected() && !whole_) {
      whole_ =
          transforms_ ? make_spectral_solver(context()) : make_sparse_solver(factor(), context());
    }
    PlateSolver& whole = steps.are_reflected() ? *whole_ : solver;
    if (problem.law) {
      const ContactHelp help{whole, contact_memory_};
      return advance_plastic(solver, problem, steps, std::move(state), &help);
    }
    return advance_with_contact(solver, whole, contact_memory_, problem, steps, std::move(state));
  }

  bool is_transformed(const Outline& outline, const Stiffness& stiffness, bool is_exact) const {
    if (!may_transform() || outline.is_periodic() || !outline.is_rectangle()) return false;
    // Exact steps in sine space have clamped edges only.
    if (is_exact && !outline.edges().are_clamped()) return false;
    return choice_ == SolverChoice::Spectral || worth_transforming(outline.grid(), stiffness);
  }

  bool may_transform() const {
    return choice_ == SolverChoice::Auto || choice_ == SolverChoice::Spectral;
  }
  SolverChoice factor() const { return may_transform() ? available_solvers().front() : choice_; }

  SolverChoice choice_;
  std::unique_ptr<PlateSolver> solver_;
  std::unique_ptr<PlateSolver> whole_;  // of the same kind; null: none was needed
  bool transforms_ = false;
  ContactMemory contact_memory_;
  SolverCounts past_counts_;  // of the solvers that were destroyed
};

}  // namespace

Result<PlateState> PlateSolver::advance(const PlateProblem& problem, const TimeSteps& steps,
                                        PlateState state) {
  return advance_in_steps(*this, problem, steps, std::move(state));
}

Result<void> PlateSolver::solve_for(const std::vector<int>&, const Field& right_hand_sides,
                                    std::span<const UnknownRun>, Field& solution) {
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
