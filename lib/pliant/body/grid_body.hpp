#pragma once

#include <memory>
#include <vector>

#include "pliant/body/body.hpp"
#include "pliant/body/workspace.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/plate/solver_cache.hpp"
#include "pliant/plate/vibration_cache.hpp"

namespace pliant {

/// The outline of a patch's plate, in a grid.
Outline outline_of(const Grid& grid, const Patch& patch);

/// The factors of the grid's nodes on those of a patch's box, in their order. Null stays null.
std::shared_ptr<const NodeFactors> factors_on(const Grid& grid, const Patch& patch,
                                              const std::shared_ptr<const NodeFactors>& factors);

/// Poisson's ratio of a patch's plate: 0 where it has no effect.
double poisson_of(const BodyInputs& inputs, const Patch& patch, const NodeFactors* factors);

/// One elastic surface as a grid of nodes. Thesis 5.3; SPEC 6.
class GridBody final : public Body {
 public:
  /// Starts at rest. Requires: `rest` is #nodes x 3, object space, finite; at least 3 x 3 nodes.
  /// `solver` and `context` are those of its plates; the context's profile receives the times of
  /// its steps. `factors` null: the material is even.
  GridBody(const Grid& grid, Field rest, const BodySettings& settings,
           SolverChoice solver = SolverChoice::Auto, RunContext context = {},
           std::shared_ptr<const NodeFactors> factors = {});

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
  void begin_next();
  void keep_solvers();
  Result<void> solve(const BodyInputs& inputs);
  void fit_factors(const Patch& patch, PatchSolve& one) const;
  Result<Dynamics> dynamics_of(const BodyInputs& inputs, const Region& region, std::size_t place);
  void begin_load(const Box& box, PlateProblem& problem) const;
  template <class F>
  void for_each_moved(const F& f) const;
  void keep_push(const BodyInputs& inputs);
  Result<void> take();
  void mark_unsettled();

  Grid grid_;
  RunContext context_;
  SolverCache solvers_;
  VibrationCache vibrations_;
  BodyWorkspace work_;
};

}  // namespace pliant
