#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/feedback/preview.hpp"
#include "pliant/sampling/rest_shape.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// How a surface should move. A goal that is absent leaves its numbers alone.
struct MotionGoals {
  std::string surface = {};  ///< its name; empty: the only one on which forces act
  std::string force = {};    ///< the name of a force, or of a group with all its forces, which acts
                             ///< alone; empty: all forces of the surface together

  /// The largest displacement in the animation, world [length], > 0: by the magnitudes.
  std::optional<double> peak = {};
  /// When it settles, as `RegionPreview::settling` [s], > 0: by the damping, or the damping ratio.
  std::optional<double> settling = {};
  /// Its frequency in the animation, as `RegionPreview::animated` [Hz], > 0: by the density.
  std::optional<double> frequency = {};
};

/// Why a goal is missed.
enum class Obstacle {
  None,
  NothingMoves,   ///< no force reaches a node that can move, or all magnitudes are keyed to 0
  LeavesReach,    ///< the surface moves out of the reach of its forces
  MovesAnyway,    ///< it moves further than that without its forces
  StepsDamp,      ///< backward Euler's steps alone make it settle sooner
  StepsTooLong,   ///< backward Euler's steps are too long for that frequency
  Overdamped,     ///< with its damping, which is to stay, it does not ring that fast
  TooSoon,        ///< with more damping it creeps, and takes longer again
  BetweenSwings,  ///< it would have to settle in the middle of a swing
  FrameRate,      ///< the frames are too far apart to show that frequency
  NoInertia,      ///< without density nothing rings, and a damping ratio damps nothing
  NoDamping,      ///< its damping acts on nothing, or is keyed to 0
  NotHeld,        ///< nothing holds the surface, so it does not settle
  TooLarge,       ///< it has too many nodes for a preview
  NoCycle,        ///< the motion of a loop closes to no cycle
  NotFound,       ///< the animation was played too often without an end
};

/// Its name in JSON, such as "leavesReach"; "none".
std::string_view name_of(Obstacle obstacle);

/// A goal beside what the changed scene does.
struct GoalResult {
  double wanted = 0;
  double found = 0;      ///< of the changed scene; infinite: it never settles
  bool is_known = true;  ///< false: `found` is not known
  Obstacle obstacle = Obstacle::None;
  std::string reason = {};  ///< one line of the obstacle, with what would help

  /// How far it is off, of what is wanted [1]; infinite if `found` is not known.
  double miss() const;
};

/// A goal is met if it is missed by no more than this [1].
inline constexpr double goal_tolerance = 0.02;

/// A channel that a goal changes.
struct SuggestedValue {
  std::string path;      ///< `poke.magnitude`
  double before = 0;     ///< the constant, or of the keys' values the one farthest from 0
  double after = 0;      ///< the same in the changed scene
  std::size_t keys = 0;  ///< 0: a constant
};

/// A scene whose motion is nearer to some goals.
struct Suggestion {
  /// The scene with other magnitudes, density and damping, rounded to 4 significant digits: of keys
  /// all values are multiplied, finer where the whole curve changes less, so that their timing
  /// stays. Its notes and lines are those of the scene before.
  Scene scene;
  std::vector<SuggestedValue> values;  ///< that the goals may change, also those that are kept
  Preview before;                      ///< of what acts, in the scene as it was; played only if
                                       ///< that was needed
  Preview after;                   ///< in the changed scene: the figures of the goals; played if
                                   ///< a peak is one
  std::size_t region = 0;          ///< of `after.regions`, whose motion is told
  std::optional<GoalResult> peak;  ///< null: no goal
  std::optional<GoalResult> settling;
  std::optional<GoalResult> frequency;
  std::vector<std::string> notes = {};  ///< what the changes do beyond the goals, one line each

  /// Whether all goals are met, to `goal_tolerance`.
  bool meets_goals() const;
};

/// Finds magnitudes, density and damping with which a surface moves as wanted: docs/model.md,
/// "Suggestions". All forces that act are scaled by one factor, so that signs and shares stay; one
/// that could push and has the constant magnitude 0 begins with 1 if nothing moves. With a damping
/// ratio in the scene that takes the damping's place. What cannot be reached is no error: the
/// result has the nearest that can, and the reason.
///
/// Cost: a preview of these forces, more if the surface yields, and for a peak playing the whole
/// animation at most 24 times, usually twice; a loop from the beginning of its cycle on. Errors:
/// InvalidInput if no goal is given, a goal is not finite and > 0, or a name is unknown, not alone,
/// or of a surface that is not solved; those of `preview_forces`.
Result<Suggestion> suggest_material(const Scene& scene, std::span<const RestShape> rest_shapes,
                                    const MotionGoals& goals, const RunContext& context = {});

}  // namespace pliant
