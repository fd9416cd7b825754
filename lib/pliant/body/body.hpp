#pragma once

#include <span>
#include <vector>

#include "pliant/body/settings.hpp"
#include "pliant/body/state.hpp"
#include "pliant/body/workspace.hpp"
#include "pliant/core/profile.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/core/transform.hpp"
#include "pliant/forces/force.hpp"
#include "pliant/plate/plate.hpp"
#include "pliant/plate/solver_cache.hpp"
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

  /// For each force the one whose deformation box is its own, which says in which island it acts;
  /// empty: each has its own.
  std::vector<int> selectors = {};
};

/// What happens in a frame.
struct StepReport {
  Selection selection;  ///< what the forces selected, in the order of the inputs, and its regions
  std::vector<std::vector<Patch>> patches;  ///< what is solved of each region; none: too small
  bool is_solved = false;                   ///< whether anything is
  TimeSteps steps;                          ///< of the solve
  std::vector<int> lost;  ///< forces that hold nodes of the rest mesh, but none as it stands
  std::vector<bool>
      pushing;         ///< of each force: whether it moves any node; in the order of the inputs
  int recovering = 0;  ///< nodes that are solved because they are not back at rest
  std::vector<int> settling;  ///< nodes that are put at rest ahead of the solve, ascending

  int unknown_count() const;  ///< nodes that move, of all patches

  /// The patches that force k of the inputs acts in.
  std::span<const Patch> patches_of_force(std::size_t k) const;
};

/// One elastic surface as a grid of nodes: its state, and one frame's step. Thesis 5.3; SPEC 6.
class Body {
 public:
  /// Starts at rest. Requires: `rest` is #nodes x 3, object space, finite; at least 3 x 3 nodes.
  Body(const Grid& grid, Field rest, const BodySettings& settings,
       SolverCache solvers = SolverCache());

  /// The rest mesh, and no carried velocity.
  void reset();

  /// What `step` would do with these inputs, without doing it. Errors: NotFinite when a node is
  /// not, in world space.
  Result<StepReport> look(const BodyInputs& inputs) const;

  /// Solves one frame: selects the regions on the mesh as it stands, and moves their interiors from
  /// here to the next frame. A node that the last solve did not touch starts with velocity 0, any
  /// other with what the last solve left it; a frame without a solve changes neither. Errors:
  /// NotFinite when a node or the new state is not; Interrupted when `should_stop` says so; those
  /// of the solver. The state is then as it was.
  ///
  /// The report takes the memory of `reuse`, a report of an earlier step of this body or none. With
  /// it nothing is allocated while the regions stay, in sine space and where nothing recovers.
  /// `profile` is told where the time goes; none: nobody asks.
  Result<StepReport> step(const BodyInputs& inputs, const StopRequest& should_stop = {},
                          StepReport reuse = {}, Profile* profile = nullptr);

  const Grid& grid() const { return grid_; }
  const Field& rest() const { return rest_; }  ///< #nodes x 3, object space [length]
  const BodyState& state() const { return state_; }
  SolverCounts solver_counts() const { return solvers_.counts(); }

  /// Where the forces' distances are measured (#nodes x 3, world space).
  Field measured_nodes(const Transform& transform) const;

  BodyState rest_state() const;  ///< after a `reset`

  /// Continues from `state`, which came from `state()` of a body like this one.
  void restore(BodyState state);

 private:
  const Field& measured() const {
    return settings_.measure == Measure::Rest ? rest_ : state_.positions;
  }
  Result<StepReport> plan(const BodyInputs& inputs, BodyWorkspace& work, StepReport report,
                          Profile* profile) const;
  std::vector<int> lost_forces(const BodyInputs& inputs, const Selection& selection,
                               BodyWorkspace& work, std::vector<int> lost) const;
  void settle(const std::vector<int>& nodes);
  void begin_next(const StepReport& report);
  void keep_solvers(const StepReport& report);
  Result<void> solve(const BodyInputs& inputs, const StepReport& report,
                     const StopRequest& should_stop, Profile* profile);
  Result<void> take();
  void mark_unsettled();
  bool recovers() const { return settings_.release == Release::Recover; }

  Grid grid_;
  Field rest_;
  BodySettings settings_;
  BodyState state_;
  SolverCache solvers_;
  BodyWorkspace work_;
};

}  // namespace pliant
