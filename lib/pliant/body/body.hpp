#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "pliant/body/settings.hpp"
#include "pliant/body/state.hpp"
#include "pliant/body/step_plan.hpp"
#include "pliant/contact/collider.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/transform.hpp"
#include "pliant/forces/force.hpp"
#include "pliant/plate/plate.hpp"
#include "pliant/plate/plate_problem.hpp"
#include "pliant/plate/solver_choice.hpp"
#include "pliant/region/placed_nodes.hpp"

namespace pliant {

/// How a surface moves on the way to the next frame, apart from its displacement.
struct BodyMotion {
  Placement first, last;                         ///< of its transform
  std::shared_ptr<const Field> next_shape = {};  ///< at rest, at the next frame; null: as now
};

/// All inputs that act on a body during one frame, sampled at the frame.
struct BodyInputs {
  Transform transform;  ///< object to world; invertible
  Stiffness stiffness;  ///< elliptic
  Dynamics dynamics;    ///< density, damping >= 0; see `damping_ratio`
  /// >= 0, of the slowest vibration of each region: its damping follows; null: it is `dynamics`'
  std::optional<double> damping_ratio = {};
  EdgeTangents tangents;  ///< object space
  double poisson = 0.3;   ///< acts with a free border or edge, maps of b, c, d, and a law [1]
  std::optional<PlasticLaw> law = {};  ///< of a body that yields, and of no other
  double goal = 0;                     ///< >= 0, pulls back to rest [1/uv^4]
  double frame_length = 0;             ///< [s], > 0
  double dt = 0;                       ///< [s], accepted by `check_time_step`
  std::vector<SampledForce> forces;    ///< the enabled ones that target the body, world space

  /// The rest shape at the frame if it is animated (#nodes x 3, object space); null otherwise.
  std::shared_ptr<const Field> shape = {};

  /// For each force the index of the force whose deformation box it uses, which determines the
  /// island it acts in; empty: each uses its own.
  std::vector<int> selectors = {};

  /// The solids that it meets: the enabled ones that target the body, with a deformation radius of
  /// 0 where they select nothing. Not with Reference::None or exact steps.
  std::vector<SampledCollider> colliders = {};
  std::optional<BodyMotion> motion = {};  ///< if there are colliders

  bool selects_by_colliders() const {
    return std::ranges::any_of(
        colliders, [](const SampledCollider& one) { return one.deformation_radius > 0; });
  }

  /// Whether the damping depends on the slowest vibrations.
  bool asks_for_vibrations() const {
    return damping_ratio && *damping_ratio > 0 && dynamics.density > 0;
  }
};

/// The dynamics that act: density is 0 if its map is 0 everywhere, and so is damping. `factors` are
/// those of the nodes; null: the material is even.
Dynamics acting_dynamics(const Dynamics& dynamics, const NodeFactors* factors);

/// The steps of a frame. Without density there is nothing that swings: they are backward Euler's,
/// unless they are exact; static frames have one step of backward Euler then.
TimeSteps steps_of(const BodyInputs& inputs, const BodySettings& settings,
                   const NodeFactors* factors = nullptr);

class PatchPlate;

/// A patch that a plan moves.
struct MovedPatch {
  std::vector<int> nodes;     ///< that move, in the order of the unknowns of its plate
  bool is_rectangle = false;  ///< false: its plate needs a sparse factor
};

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

  /// The same in less time if `earlier`, a plan of this body or an empty one, has the same patches.
  virtual Result<StepPlan> look_again(const BodyInputs& inputs, StepPlan&& /*earlier*/) const {
    return look(inputs);
  }

  /// Solves one frame: selects the regions, and moves what is inside them to the next frame. A node
  /// that the last solve did not move starts with velocity 0, any other with its velocity from the
  /// last solve; a frame without a solve changes neither. Errors: NotFinite if a node or the new
  /// state is not finite; Interrupted; those of the solver. The state is then unchanged.
  virtual Result<void> step(const BodyInputs& inputs) = 0;

  /// The plan of the last step; empty before the first.
  virtual const StepPlan& last_step() const = 0;

  /// The velocities that the last step that solved began with; #nodes x 3.
  virtual const Field& velocities_before() const = 0;

  /// The effect of a force, by its index in the inputs, in the step that `plan` plans for them.
  virtual Push push_of(const BodyInputs& inputs, const StepPlan& plan, std::size_t force) const = 0;

  /// The patches of a region; each patch of a surface of triangles is one. Requires: the plan
  /// solves it.
  virtual std::vector<MovedPatch> moved_patches(const StepPlan& plan, std::size_t region) const = 0;

  /// One of these patches by itself.
  virtual std::unique_ptr<PatchPlate> plate_of(const BodyInputs& inputs, const StepPlan& plan,
                                               std::size_t region, std::size_t patch) const = 0;

  virtual SolverCounts solver_counts() const = 0;

  /// The positions of its state at rest, #nodes x 3, object space [length]: 0 if the rest shape is
  /// animated.
  const Field& rest() const { return rest_; }
  const BodyState& state() const { return state_; }
  const BodySettings& settings() const { return settings_; }

  /// The factors of the material at the nodes; null: it is even.
  const std::shared_ptr<const NodeFactors>& factors() const { return factors_; }

  /// The nodes from which the forces' distances are measured (#nodes x 3, object space); `room` is
  /// memory for them.
  const Field& measured(const BodyInputs& inputs, Field& room) const;

  BodyState rest_state() const;  ///< after a `reset`

  /// A frame passes without a solve: what touched in the one before does so no longer.
  void touch_nothing() { state_.contacts.clear(); }

  /// Continues from `state`, the result of `state()` of a body like this one.
  void restore(BodyState state);

 protected:
  /// `plastic_places`: the nodes or triangles that have plastic curvatures if the body yields.
  /// `faces` null: no force uses normals.
  Body(Field rest, Eigen::Index plastic_places, const BodySettings& settings,
       std::shared_ptr<const NodeFactors> factors, std::shared_ptr<const NodeMarks> held,
       std::shared_ptr<const NodeFaces> faces);

  /// Nodes in object space (#nodes x 3), as forces use them. Requires: they outlive the result.
  PlacedNodes placed(const Field& nodes, const BodyInputs& inputs) const {
    return {nodes, inputs.transform, densities(), faces_.get()};
  }

  /// The nodes' factors of density; null: 1.
  const std::vector<double>* densities() const { return factors_ ? &factors_->density : nullptr; }

  /// Whether inertia or drag hold some node back in a step of `dt` [s].
  bool resists_motion(const Dynamics& dynamics, double dt) const {
    return acting_dynamics(dynamics, factors_.get()).shift(dt) > 0;
  }

  /// Whether the inputs have a rest shape if and only if it is animated, and a law if and only if
  /// it yields.
  bool fits(const BodyInputs& inputs) const {
    return settings_.is_animated == (inputs.shape != nullptr) &&
           settings_.yields == inputs.law.has_value();
  }

  /// The nodes at rest at the frame.
  const Field& rest_at(const BodyInputs& inputs) const {
    return inputs.shape ? *inputs.shape : rest_;
  }

  bool recovers() const { return settings_.release == Release::Recover; }

  /// Whether the next solve needs what pushed in the last one.
  bool remembers_push() const { return settings_.integrator == Integrator::Exact; }

  LastPush nothing_pushed() const;

  /// The tangents that a frame begins with, if they are `now` at its end.
  EdgeTangents first_tangents(const EdgeTangents& now) const;

  /// Puts nodes at rest that no solve moves. Requires: the body recovers.
  void put_at_rest(const std::vector<int>& nodes);

  /// Whether a frame solves the body only where forces select.
  bool waits_for_forces() const { return !recovers() && settings_.region == SolvedRegion::Forces; }

  Field rest_;
  Eigen::Index plastic_places_;
  BodySettings settings_;
  std::shared_ptr<const NodeFactors> factors_;
  std::shared_ptr<const NodeMarks> held_;  // null: no node is held
  std::shared_ptr<const NodeFaces> faces_;
  BodyState state_;
};

}  // namespace pliant
