#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "pliant/body/settings.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/core/transform.hpp"
#include "pliant/forces/force.hpp"
#include "pliant/plate/linear_solver.hpp"
#include "pliant/plate/plate.hpp"
#include "pliant/region/region.hpp"

namespace pliant {

/// Everything that acts on a body during one frame, sampled at the frame.
struct BodyInputs {
  Transform transform;               ///< object to world; invertible
  Stiffness stiffness;               ///< elliptic
  Dynamics dynamics;                 ///< density, damping >= 0
  EdgeTangents tangents;             ///< object space
  double frame_length = 0;           ///< [s], > 0
  double dt = 0;                     ///< [s], as `check_time_step` allows
  std::vector<SampledForce> forces;  ///< the enabled ones that target the body, world space
};

/// The state that one frame hands to the next.
struct BodyState {
  Field positions;   ///< #nodes x 3, object space [length]
  Field velocities;  ///< #nodes x 3: of the last solve, 0 where it did not touch [length/s]

  friend bool operator==(const BodyState&, const BodyState&) = default;
};

/// What happened in a frame.
struct StepReport {
  Selection selection;     ///< what the forces selected, in the order of the inputs
  bool is_solved = false;  ///< false: nothing selected, or a region smaller than 3 x 3
  TimeSteps steps;         ///< of the solve
  std::vector<int> lost;   ///< forces that hold nodes of the rest mesh, but none as it stands
};

/// One elastic surface as a grid of nodes: its state, and one frame's step. Thesis 5.3; SPEC 6.
class Body {
 public:
  /// Starts at rest. Requires: `rest` is #nodes x 3, object space, finite; at least 3 x 3 nodes.
  /// The solver takes its memory out of `budget`, which outlives the body; none: no limit.
  Body(const Grid& grid, Field rest, const BodySettings& settings, MemoryBudget* budget = nullptr);

  /// The rest mesh, and no carried velocity.
  void reset();

  /// Solves one frame: selects the region on the mesh as it stands, and moves its interior from
  /// here to the next frame. A node that the last solve did not touch starts with velocity 0, any
  /// other with what the last solve left it; a frame without a solve changes neither. Errors:
  /// NotFinite when the new state is not; Interrupted when `should_stop` says so; those of the
  /// solver. The state is then as it was.
  Result<StepReport> step(const BodyInputs& inputs, const StopRequest& should_stop = {});

  const Grid& grid() const { return grid_; }
  const Field& rest() const { return rest_; }  ///< #nodes x 3, object space [length]
  const BodyState& state() const { return state_; }
  SolverCounts solver_counts() const { return solver_->counts(); }

  /// Continues from `state`, which came from `state()` of a body like this one.
  void restore(BodyState state);

 private:
  Result<void> solve(const Box& region, const Field& load, const BodyInputs& inputs,
                     const TimeSteps& steps, const StopRequest& should_stop);

  Grid grid_;
  Field rest_;
  BodySettings settings_;
  BodyState state_;
  std::unique_ptr<LinearSolver> solver_;
};

}  // namespace pliant
