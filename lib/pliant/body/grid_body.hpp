#pragma once

#include <vector>

#include "pliant/body/body.hpp"
#include "pliant/body/workspace.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/plate/solver_cache.hpp"

namespace pliant {

/// One elastic surface as a grid of nodes. Thesis 5.3; SPEC 6.
class GridBody final : public Body {
 public:
  /// Starts at rest. Requires: `rest` is #nodes x 3, object space, finite; at least 3 x 3 nodes.
  /// `solver` and `context` are those of its plates; the context's profile receives the times of
  /// its steps.
  GridBody(const Grid& grid, Field rest, const BodySettings& settings,
           SolverChoice solver = SolverChoice::Auto, RunContext context = {});

  Result<StepPlan> look(const BodyInputs& inputs) const override;

  /// Nothing is allocated while the regions stay the same, plates are solved in sine space, no node
  /// recovers and the grid is open.
  Result<void> step(const BodyInputs& inputs) override;

  const StepPlan& last_step() const override { return work_.plan; }
  Push push_of(const BodyInputs& inputs, const StepPlan& plan, std::size_t force) const override;
  SolverCounts solver_counts() const override { return solvers_.counts(); }

  const Grid& grid() const { return grid_; }

 private:
  Result<void> plan(const BodyInputs& inputs, BodyWorkspace& work) const;
  void find_lost(const BodyInputs& inputs, BodyWorkspace& work) const;
  void settle(const std::vector<int>& nodes);
  void begin_next();
  void keep_solvers();
  Result<void> solve(const BodyInputs& inputs);
  Result<void> take();
  void mark_unsettled();

  Grid grid_;
  Profile* profile_;  // null: no profiling
  SolverCache solvers_;
  BodyWorkspace work_;
};

}  // namespace pliant
