#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "pliant/core/expects.hpp"
#include "pliant/core/stage_timer.hpp"
#include "pliant/plate/exact/sparse_motion.hpp"
#include "pliant/plate/rim_load.hpp"
#include "pliant/plate/solver_factories.hpp"
#include "pliant/plate/sparse/factored_matrix.hpp"
#include "pliant/plate/sparse/operator.hpp"

namespace pliant {
namespace {

// A solver that factors the sparse matrix of its outline.
class DirectSolver final : public PlateSolver {
 public:
  DirectSolver(SolverChoice choice, const RunContext& context)
      : PlateSolver(context), matrix_(choice, context), motion_(context) {}

  Result<void> prepare(const PlateSystem& system) override {
    if (factored_ == system) return {};
    const bool same_pattern = factored_ && have_same_nodes(factored_->outline, system.outline);
    factored_.reset();
    auto factored = matrix_.factor(unknown_count(system.outline), same_pattern,
                                   [&] { return assemble_upper(system); });
    if (!factored) return factored;
    factored_ = system;
    refinement_passes_ = passes_for(estimate_condition(system));
    return {};
  }

  Result<Field> solve(const Field& right_hand_sides) override {
    PLIANT_EXPECTS(factored_ && right_hand_sides.rows() == unknown_count(factored_->outline));
    matrix_.count_solve();
    auto solution = matrix_.solve(right_hand_sides);
    for (int pass = 0; solution && pass < refinement_passes_; ++pass) {
      auto correction = matrix_.solve(residual(*factored_, *solution, right_hand_sides));
      if (!correction) return correction;
      *solution += *correction;
    }
    return solution;
  }

  Result<PlateState> advance(const PlateProblem& problem, const TimeSteps& steps,
                             PlateState state) override {
    if (!steps.are_exact()) return PlateSolver::advance(problem, steps, std::move(state));
    PLIANT_EXPECTS(is_on_nodes(problem, state));
    const Outline& outline = problem.outline;
    StageTimer set_up(context().profile, Stage::SetUp);
    const auto unknowns = static_cast<std::size_t>(unknown_count(outline));
    auto prepared = motion_.prepare({assemble_upper({outline, problem.stiffness, 0}),
                                     std::vector<double>(unknowns, problem.dynamics.density),
                                     std::vector<double>(unknowns, problem.dynamics.damping)});
    if (!prepared) return fail(prepared.error());
    set_up.stop();
    const StageTimer solve(context().profile, Stage::Solve);
    const auto force = [&](Field load, const EdgeTangents& tangents) {
      subtract_rim(outline, problem.stiffness, tangents, state.displacement, load);
      return interior_of(outline, load);
    };
    Field w = interior_of(outline, state.displacement), v = interior_of(outline, state.velocity);
    auto moved = motion_.advance(
        steps,
        {force(problem.first_load, problem.first_tangents), force(problem.load, problem.tangents)},
        w, v);
    if (!moved) return fail(moved.error());
    return with_interior(problem, std::move(state), w, v);
  }

  SolverCounts counts() const override { return matrix_.counts() + motion_.counts(); }

  std::size_t memory() const override { return matrix_.memory() + motion_.memory(); }

 private:
  // Iterative refinement. A factorisation leaves a relative error of up to condition x eps, and
  // each pass with an exact residual multiplies the error by that factor again. Without it a static
  // plate of 401 x 401 is off by 1e-8. One pass if the error may exceed 2e-9, two if it may exceed
  // 1e-5.
  static int passes_for(double condition) {
    if (!(condition < 1e11)) return 2;
    return condition > 1e7 ? 1 : 0;
  }

  FactoredMatrix matrix_;
  std::optional<PlateSystem> factored_;  // the system of `matrix_`; nullopt after a failure
  int refinement_passes_ = 0;            // needed for `factored_`
  SparseMotion motion_;
};

}  // namespace

std::unique_ptr<PlateSolver> make_sparse_solver(SolverChoice choice, const RunContext& context) {
  return std::make_unique<DirectSolver>(choice, context);
}

}  // namespace pliant
