#include "pliant/plate/plate_solver.hpp"

#include <algorithm>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/plate/advance.hpp"
#include "pliant/plate/overlap/rectangle_cover.hpp"
#include "pliant/plate/solver_factories.hpp"

namespace pliant {
namespace {

// Creates the solver that suits each problem, and destroys the previous one if it was of another
// kind.
class AutomaticPlateSolver final : public PlateSolver {
 public:
  AutomaticPlateSolver(bool prefers_spectral, const RunContext& context)
      : PlateSolver(context), prefers_spectral_(prefers_spectral) {}

  Result<void> prepare(const PlateSystem& system) override {
    return suited(system.outline, system.stiffness).prepare(system);
  }

  Result<Field> solve(const Field& right_hand_sides) override {
    PLIANT_EXPECTS(solver_ != nullptr);
    return solver_->solve(right_hand_sides);
  }

  Result<PlateState> advance(const PlateProblem& problem, const TimeSteps& steps,
                             PlateState state) override {
    return suited(problem.outline, problem.stiffness).advance(problem, steps, std::move(state));
  }

  SolverCounts counts() const override {
    return solver_ ? past_counts_ + solver_->counts() : past_counts_;
  }

  std::size_t memory() const override { return solver_ ? solver_->memory() : 0; }

 private:
  enum class Way { Spectral, Schwarz, Direct };

  PlateSolver& suited(const Outline& outline, const Stiffness& stiffness) {
    const Way way = way_of(outline, stiffness);
    if (!solver_ || way != way_) {
      past_counts_ = counts();
      solver_.reset();
      way_ = way;
      solver_ = make(way);
    }
    return *solver_;
  }

  Way way_of(const Outline& outline, const Stiffness& stiffness) {
    if (outline.is_periodic()) return Way::Direct;
    if (outline.is_rectangle()) {
      const bool is_worth_it = prefers_spectral_ || worth_transforming(outline.grid(), stiffness);
      return is_worth_it ? Way::Spectral : Way::Direct;
    }
    const bool is_worth_it =
        worth_iterating(outline.unknown_count(), stiffness) && is_covered(outline);
    return is_worth_it ? Way::Schwarz : Way::Direct;
  }

  // Caches the answer for the last outline.
  bool is_covered(const Outline& outline) {
    if (!have_same_nodes(outline, asked_for_)) {
      asked_for_ = outline;
      is_covered_ = !cover_by_rectangles(outline).empty();
    }
    return is_covered_;
  }

  std::unique_ptr<PlateSolver> make(Way way) const {
    switch (way) {
      case Way::Spectral:
        return make_spectral_solver(context());
      case Way::Schwarz:
        return make_schwarz_solver(context());
      default:
        return make_sparse_solver(available_solvers().front(), context());
    }
  }

  bool prefers_spectral_;
  std::unique_ptr<PlateSolver> solver_;
  Way way_ = Way::Direct;
  Outline asked_for_;
  bool is_covered_ = false;
  SolverCounts past_counts_;  // of the solvers that were destroyed
};

}  // namespace

Result<PlateState> PlateSolver::advance(const PlateProblem& problem, const TimeSteps& steps,
                                        PlateState state) {
  return advance_in_steps(*this, problem, steps, std::move(state));
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

bool worth_iterating(int unknowns, const Stiffness& stiffness) {
  // Does not depend on the memory too: another machine would choose another solver and get other
  // bits.
  constexpr int most_to_factor = 150'000;
  // A static L of 100 nodes a side needs 11 rounds with c = 2, 20 with c 5 % from its bound, 40
  // with 0.05 %; there a larger plate needs more.
  constexpr double closest = 0.02;
  return unknowns >= most_to_factor &&
         stiffness.c - stiffness.least_c() >= -closest * stiffness.least_c();
}

std::unique_ptr<PlateSolver> make_plate_solver(SolverChoice choice, const RunContext& context) {
  PLIANT_EXPECTS(is_available(choice));
  if (choice == SolverChoice::Auto || choice == SolverChoice::Spectral) {
    return std::make_unique<AutomaticPlateSolver>(choice == SolverChoice::Spectral, context);
  }
  return make_sparse_solver(choice, context);
}

}  // namespace pliant
