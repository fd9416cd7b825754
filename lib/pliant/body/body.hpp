#pragma once

#include <cstddef>
#include <vector>

#include "pliant/body/settings.hpp"
#include "pliant/body/state.hpp"
#include "pliant/body/step_plan.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/transform.hpp"
#include "pliant/forces/force.hpp"
#include "pliant/plate/plate.hpp"
#include "pliant/plate/solver_choice.hpp"

namespace pliant {

/// All inputs that act on a body during one frame, sampled at the frame.
struct BodyInputs {
  Transform transform;               ///< object to world; invertible
  Stiffness stiffness;               ///< elliptic
  Dynamics dynamics;                 ///< density, damping >= 0
  EdgeTangents tangents;             ///< object space
  double poisson = 0.3;              ///< of a surface with a free border [1]
  double frame_length = 0;           ///< [s], > 0
  double dt = 0;                     ///< [s], accepted by `check_time_step`
  std::vector<SampledForce> forces;  ///< the enabled ones that target the body, world space

  /// For each force the index of the force whose deformation box it uses, which determines the
  /// island it acts in; empty: each uses its own.
  std::vector<int> selectors = {};
};

/// The steps of a frame. Without density there is nothing that swings: they are backward Euler's.
TimeSteps steps_of(const BodyInputs& inputs, const BodySettings& settings);

/// One elastic surface: its state, and one frame's step. Thesis 5.3; SPEC 6.
class Body {
 public:
  Body(const Body&) = delete;
  Body& operator=(const Body&) = delete;
  virtual ~Body() = default;

  /// Sets the rest mesh and removes all velocity.
  void reset() { state_ = rest_state(); }

  /// The plan of the step that `step` would do. Errors: NotFinite if a node is not finite in world
  /// space.
  virtual Result<StepPlan> look(const BodyInputs& inputs) const = 0;

  /// Solves one frame: selects the regions, and moves what is inside them to the next frame. A node
  /// that the last solve did not move starts with velocity 0, any other with its velocity from the
  /// last solve; a frame without a solve changes neither. Errors: NotFinite if a node or the new
  /// state is not finite; Interrupted; those of the solver. The state is then unchanged.
  virtual Result<void> step(const BodyInputs& inputs) = 0;

  /// The plan of the last step; empty before the first.
  virtual const StepPlan& last_step() const = 0;

  /// The effect of a force, by its index in the inputs, in the step that `plan` plans for them.
  virtual Push push_of(const BodyInputs& inputs, const StepPlan& plan, std::size_t force) const = 0;

  virtual SolverCounts solver_counts() const = 0;

  const Field& rest() const { return rest_; }  ///< #nodes x 3, object space [length]
  const BodyState& state() const { return state_; }
  const BodySettings& settings() const { return settings_; }

  /// The nodes from which the forces' distances are measured (#nodes x 3, object space).
  const Field& measured() const {
    return settings_.measure == Measure::Rest ? rest_ : state_.positions;
  }

  BodyState rest_state() const;  ///< after a `reset`

  /// Continues from `state`, the result of `state()` of a body like this one.
  void restore(BodyState state);

 protected:
  Body(Field rest, const BodySettings& settings);

  bool recovers() const { return settings_.release == Release::Recover; }

  /// Whether a frame solves the body only where forces select.
  bool waits_for_forces() const { return !recovers() && settings_.region == SolvedRegion::Forces; }

  Field rest_;
  BodySettings settings_;
  BodyState state_;
};

}  // namespace pliant
