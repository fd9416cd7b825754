#include <new>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/plate/load_copy.hpp"
#include "pliant/plate/overlap/schwarz_plate.hpp"
#include "pliant/plate/rim_load.hpp"
#include "pliant/plate/solver_errors.hpp"
#include "pliant/plate/solver_factories.hpp"

namespace pliant {
namespace {

class SchwarzSolver final : public PlateSolver {
 public:
  SchwarzSolver(const RunContext& context, int max_rounds)
      : PlateSolver(context), max_rounds_(max_rounds), load_(context.memory) {}

  Result<void> prepare(const PlateSystem& system) override {
    system_ = system;
    let_factor_go();
    auto ready = prepare_plate(system.outline, system.stiffness, system.shift);
    const bool has_failed = !ready && ready.error().code == ErrorCode::SolverFailed;
    return has_failed ? factor() : ready;
  }

  Result<Field> solve(const Field& right_hand_sides) override try {
    if (!factor_) {
      const Outline& outline = system_.outline;
      const long M = outline.grid().columns, count = outline.grid().node_count();
      Field solution = Field::Zero(count, 3);
      const Field load = with_interior(outline, solution, right_hand_sides);
      const auto done = plate_->solve({load.data(), M, count}, {solution.data(), M, count});
      if (done) return interior_of(outline, solution);
      if (done.error().code != ErrorCode::SolverFailed) return fail(done.error());
      if (auto factored = factor(); !factored) return fail(factored.error());
    }
    return factor_->solve(right_hand_sides);
  } catch (const std::bad_alloc&) {
    return fail(no_memory_to_solve(right_hand_sides.rows(), "does not fit in memory"));
  }

  Result<PlateState> advance(const PlateProblem& problem, const TimeSteps& steps,
                             PlateState state) override try {
    const Grid& grid = problem.outline.grid();
    PLIANT_EXPECTS(is_on_nodes(problem, state));
    if (steps.are_reflected()) return PlateSolver::advance(problem, steps, std::move(state));
    const double inertia = problem.dynamics.inertia(steps.length);
    const double shift = problem.dynamics.shift(steps.length);
    let_factor_go();
    auto done = prepare_plate(problem.outline, problem.stiffness, shift);
    int step = 0;
    if (done) {
      done = load_.take(problem);
      if (!done) return fail(done.error());
      subtract_rim(problem.outline, problem.stiffness, problem.tangents, state.displacement,
                   load_.nodes());
      clear_rim(problem.outline, state.velocity);
    }
    const auto view = [&](Field& field) {
      return NodesView{field.data(), grid.columns, grid.node_count()};
    };
    for (; done && step < steps.count; ++step) {
      done = plate_->advance({load_.nodes().data(), grid.columns, grid.node_count()}, inertia,
                             steps.length, view(state.displacement), view(state.velocity));
      if (!done) break;
    }
    if (done) return state;
    if (done.error().code != ErrorCode::SolverFailed) return fail(done.error());
    return finish_directly(problem, {steps.count - step, steps.length}, std::move(state));
  } catch (const std::bad_alloc&) {
    return fail(no_memory_to_solve(problem.outline.unknown_count(), "does not fit in memory"));
  }

  SolverCounts counts() const override {
    SolverCounts sum = past_counts_;
    if (plate_) sum = sum + plate_->counts();
    if (factor_) sum = sum + factor_->counts();
    return sum;
  }
  std::size_t memory() const override {
    return load_.memory() + (plate_ ? plate_->memory() : 0) + (factor_ ? factor_->memory() : 0);
  }

 private:
  Result<void> prepare_plate(const Outline& outline, const Stiffness& stiffness, double shift) {
    if (!plate_) plate_ = std::make_unique<SchwarzPlate>(context(), max_rounds_);
    return plate_->prepare(outline, stiffness, shift);
  }

  void let_plate_go() {
    if (plate_) past_counts_ = past_counts_ + plate_->counts();
    plate_.reset();
  }

  void let_factor_go() {
    if (factor_) past_counts_ = past_counts_ + factor_->counts();
    factor_.reset();
  }

  // The rounds do not suffice: factors the matrix of the prepared system.
  Result<void> factor() {
    let_plate_go();
    factor_ = make_sparse_solver(available_solvers().front(), context());
    return factor_->prepare(system_);
  }

  // The same for the remaining steps. Nothing of it is kept, so that the next frame's result
  // depends on that frame alone.
  Result<PlateState> finish_directly(const PlateProblem& problem, const TimeSteps& steps,
                                     PlateState state) {
    let_plate_go();
    factor_ = make_sparse_solver(available_solvers().front(), context());
    auto result = factor_->advance(problem, steps, std::move(state));
    let_factor_go();
    return result;
  }

  int max_rounds_;
  std::unique_ptr<SchwarzPlate> plate_;
  PlateSystem system_;                   // the last one of `prepare`
  std::unique_ptr<PlateSolver> factor_;  // of `system_`, if rounds do not suffice
  SolverCounts past_counts_;             // of the solvers that were destroyed
  LoadCopy load_;
};

}  // namespace

std::unique_ptr<PlateSolver> make_schwarz_solver(const RunContext& context, int max_rounds) {
  return std::make_unique<SchwarzSolver>(context, max_rounds);
}

}  // namespace pliant
