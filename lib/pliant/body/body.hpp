#pragma once

#include <vector>

#include "pliant/body/settings.hpp"
#include "pliant/body/state.hpp"
#include "pliant/body/workspace.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/core/transform.hpp"
#include "pliant/forces/force.hpp"
#include "pliant/plate/plate.hpp"
#include "pliant/plate/solver_cache.hpp"

namespace pliant {

/// All inputs that act on a body during one frame, sampled at the frame.
struct BodyInputs {
  Transform transform;               ///< object to world; invertible
  Stiffness stiffness;               ///< elliptic
  Dynamics dynamics;                 ///< density, damping >= 0
  EdgeTangents tangents;             ///< object space
  double frame_length = 0;           ///< [s], > 0
  double dt = 0;                     ///< [s], accepted by `check_time_step`
  std::vector<SampledForce> forces;  ///< the enabled ones that target the body, world space

  /// For each force the index of the force whose deformation box it uses, which determines the
  /// island it acts in; empty: each uses its own.
  std::vector<int> selectors = {};
};

/// One elastic surface as a grid of nodes: its state, and one frame's step. Thesis 5.3; SPEC 6.
class Body {
 public:
  /// Starts at rest. Requires: `rest` is #nodes x 3, object space, finite; at least 3 x 3 nodes.
  /// `solver` and `context` are those of its plates; the context's profile receives the times of
  /// its steps.
  Body(const Grid& grid, Field rest, const BodySettings& settings,
       SolverChoice solver = SolverChoice::Auto, RunContext context = {});

  /// Sets the rest mesh and removes all velocity.
  void reset();

  /// The plan of the step that `step` would do. Errors: NotFinite if a node is not finite in world
  /// space.
  Result<StepPlan> look(const BodyInputs& inputs) const;

  /// Solves one frame: selects the regions on the current mesh, and moves their interiors to the
  /// next frame. A node that the last solve did not move starts with velocity 0, any other with its
  /// velocity from the last solve; a frame without a solve changes neither. Errors: NotFinite if a
  /// node or the new state is not finite; Interrupted; those of the solver. The state is then
  /// unchanged.
  ///
  /// Nothing is allocated while the regions stay the same, plates are solved in sine space and no
  /// node recovers.
  Result<void> step(const BodyInputs& inputs);

  /// The plan of the last step; empty before the first.
  const StepPlan& last_step() const { return work_.plan; }

  const Grid& grid() const { return grid_; }
  const Field& rest() const { return rest_; }  ///< #nodes x 3, object space [length]
  const BodyState& state() const { return state_; }
  SolverCounts solver_counts() const { return solvers_.counts(); }

  /// The nodes from which the forces' distances are measured (#nodes x 3, world space).
  Field measured_nodes(const Transform& transform) const;

  BodyState rest_state() const;  ///< after a `reset`

  /// Continues from `state`, the result of `state()` of a body like this one.
  void restore(BodyState state);

 private:
  const Field& measured() const {
    return settings_.measure == Measure::Rest ? rest_ : state_.positions;
  }
  Result<void> plan(const BodyInputs& inputs, BodyWorkspace& work) const;
  void find_lost(const BodyInputs& inputs, BodyWorkspace& work) const;
  void settle(const std::vector<int>& nodes);
  void begin_next();
  void keep_solvers();
  Result<void> solve(const BodyInputs& inputs);
  Result<void> take();
  void mark_unsettled();
  bool recovers() const { return settings_.release == Release::Recover; }

  Grid grid_;
  Field rest_;
  BodySettings settings_;
  BodyState state_;
  Profile* profile_;  // null: no profiling
  SolverCache solvers_;
  BodyWorkspace work_;
};

}  // namespace pliant
