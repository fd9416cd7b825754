#include <new>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/plate/load_copy.hpp"
#include "pliant/plate/rim_load.hpp"
#include "pliant/plate/schwarz_plate.hpp"
#include "pliant/plate/solver_factories.hpp"

namespace pliant {
namespace {

class SchwarzPlateSolver final : public PlateSolver {
 public:
  SchwarzPlateSolver(MemoryBudget* budget, ThreadPool* threads, int most_lanes, int max_rounds)
      : budget_(budget),
        threads_(threads),
        most_lanes_(most_lanes),
        max_rounds_(max_rounds),
        load_(budget) {}

  Result<PlateState> advance(const PlateProblem& problem, const TimeSteps& steps, PlateState state,
                             const StopRequest& should_stop) override try {
    const Grid& grid = problem.outline.grid();
    PLIANT_EXPECTS(is_on_nodes(problem, state));
    const double inertia = problem.dynamics.density / steps.length;
    const double shift = (inertia + problem.dynamics.damping) / steps.length;
    if (!plate_)
      plate_ = std::make_unique<SchwarzPlate>(budget_, threads_, max_rounds_,
                                              kernels_of_width(most_lanes_));
    auto done = plate_->prepare(problem.outline, problem.stiffness, shift);
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
                             steps.length, view(state.displacement), view(state.velocity),
                             should_stop);
      if (!done) break;
    }
    if (done) return state;
    if (done.error().code != ErrorCode::SolverFailed) return fail(done.error());
    return finish_directly(problem, {steps.count - step, steps.length}, std::move(state),
                           should_stop);
  } catch (const std::bad_alloc&) {
    return fail(no_memory_to_solve(problem.outline.unknown_count(), "does not fit in memory"));
  }

  SolverCounts counts() const override {
    return plate_ ? past_counts_ + plate_->counts() : past_counts_;
  }
  std::size_t memory() const override { return load_.memory() + (plate_ ? plate_->memory() : 0); }

 private:
  // The rounds do not suffice: factors the matrix for the remaining steps. Nothing of it is kept,
  // so that the next frame's result depends on that frame alone.
  Result<PlateState> finish_directly(const PlateProblem& problem, const TimeSteps& steps,
                                     PlateState state, const StopRequest& should_stop) {
    past_counts_ = counts();
    plate_.reset();
    const auto direct = make_solver(available_solvers().front(), budget_);
    auto result = advance_backward_euler(*direct, problem, steps, std::move(state), should_stop);
    past_counts_ = past_counts_ + direct->counts();
    return result;
  }

  MemoryBudget* budget_;
  ThreadPool* threads_;
  int most_lanes_;
  int max_rounds_;
  std::unique_ptr<SchwarzPlate> plate_;
  SolverCounts past_counts_;  // of the solvers that were destroyed
  LoadCopy load_;
};

}  // namespace

std::unique_ptr<PlateSolver> make_schwarz_plate_solver(MemoryBudget* budget, ThreadPool* threads,
                                                       int most_lanes, int max_rounds) {
  return std::make_unique<SchwarzPlateSolver>(budget, threads, most_lanes, max_rounds);
}

}  // namespace pliant
