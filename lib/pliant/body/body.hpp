#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pliant/body/settings.hpp"
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

/// The state that one frame hands to the next.
struct BodyState {
  Field positions;   ///< #nodes x 3, object space [length]
  Field velocities;  ///< #nodes x 3: of the last solve, 0 where it did not touch [length/s]

  /// With `Release::Recover`: 1 for each node that the last solve left away from rest (#nodes);
  /// otherwise empty.
  std::vector<std::uint8_t> unsettled = {};

  friend bool operator==(const BodyState&, const BodyState&) = default;
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
  Body(const Grid& grid, Field rest, const BodySettings& settings, SolverCache solvers = SolverCache());

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
  Result<StepReport> step(const BodyInputs& inputs, const StopRequest& should_stop = {});

  const Grid& grid() const { return grid_; }
  const Field& rest() const { return rest_; }  ///< #nodes x 3, object space [length]
  const BodyState& state() const { return state_; }
  SolverCounts solver_counts() const { return solvers_.counts(); }

  /// Where the forces' distances are measured (#nodes x 3, world space).
  Field measured_nodes(const Transform& transform) const;

  /// Continues from `state`, which came from `state()` of a body like this one.
  void restore(BodyState state);

 private:
  // A patch once its solve is done.
  struct Moved {
    const Patch* patch = nullptr;
    Field positions;   // #interior nodes x 3
    Field velocities;  // likewise
    double settling_length = 0;
  };

  Result<StepReport> plan(const BodyInputs& inputs, const Field& nodes) const;
  Result<std::vector<Moved>> solve(const BodyInputs& inputs, const Field& nodes,
                                   const StepReport& report, const StopRequest& should_stop);
  Result<Moved> solve(const Patch& patch, const Region& region, const Field& load,
                      const BodyInputs& inputs, const TimeSteps& steps,
                      const StopRequest& should_stop);
  void take(const std::vector<Moved>& moved);
  void mark_unsettled(const std::vector<Moved>& moved);
  void settle(const std::vector<int>& nodes);
  bool recovers() const { return settings_.release == Release::Recover; }

  Grid grid_;
  Field rest_;
  BodySettings settings_;
  BodyState state_;
  SolverCache solvers_;
};

}  // namespace pliant
