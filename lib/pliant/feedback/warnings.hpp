#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/body/state.hpp"
#include "pliant/feedback/frame_ranges.hpp"
#include "pliant/sampling/rest_shape.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// A likely mistake of the author, found during a run; the run continues.
struct Warning {
  enum class Kind {
    RegionTooSmall,  ///< fewer than 3 x 3 nodes selected: not solved
    LostNodes,       ///< a force pushes nodes of the rest mesh, but none of the present mesh
    OutsideRegion,   ///< the force box of a force with a magnitude is outside the solved region
    SelectsNothing,  ///< an enabled force selects no node and reaches no region, in all frames
    PushesNothing,   ///< a force with a magnitude pushes no moving node in all frames
    NeverStarts,     ///< the surface's start frame is after the last solved frame
    TangentsUnused,  ///< tangents other than 0, but no region is solved in all frames
    ForcesApart,     ///< boxes that do not meet form one region, since `combine` is box
    AllHeld,         ///< all nodes that a force selects on a surface are held; without a force,
                     ///< all of a surface that is solved whole
    BetweenNodes,    ///< a force reaches a surface, but no node of it
    LoosePatch,      ///< nothing holds a patch of a surface's region
    FacesLeftOut,    ///< faces of a mesh that its surface does not have
    CacheOutside,    ///< no frame of the scene is within the samples of a surface's cache
    FileLeftOut,     ///< what a mesh's file has and the mesh lacks
    NothingMoved,    ///< no frame displaces a surface, though forces target it
    KeysOutside,     ///< all keys of a channel are before or after the frames that are played
    Drifts,          ///< a surface moves away from a force that stays where it is
    FliesAway,       ///< a piece that nothing holds is farther away than the surface is large
    FrozenMoving,    ///< nodes leave the region in the middle of their motion
    RadiusExceeds,   ///< a force radius above the deformation radius
    RadiusUnused,    ///< a deformation radius where all of a surface is solved
    NeverMoves,      ///< inertia of a surface that stands still
    MapOutside,      ///< values of a map, and what it makes of them, outside 0 to 1
    BeginsInside,    ///< nodes are inside a collider as it begins to act
    HeldInside,      ///< nodes that do not move are inside a collider
    Squeezed,        ///< a collider presses nodes against another one
    PassesBetween,   ///< a collider is smaller than the distance of a surface's nodes
  };
  Kind kind = Kind::RegionTooSmall;
  std::string surface;  ///< empty: all, for a force that selects nothing on any surface
  std::string force;    ///< group or collider; empty: the warning is about the surface itself
  FrameRanges frames;
  /// For ForcesApart: the forces besides `force`; for Squeezed: the other collider.
  std::vector<std::string> others = {};
  bool is_group = false;                   ///< whether `force` is the region of a group
  int faces = 0;                           ///< for FacesLeftOut
  NodesInside inside = {};                 ///< for BeginsInside, HeldInside: the most, the deepest
  std::string left_out = {};               ///< for FileLeftOut: `Mesh::left_out`
  std::optional<CacheSummary> cache = {};  ///< for CacheOutside
  bool is_cache_late = false;              ///< whether the samples are after the scene's frames
  /// Whether it tells of frames that lack some of the scene's, which were not played: there what
  /// never happened may still happen.
  bool is_of_part = false;
  bool is_still = false;     ///< whether the surface did not move at all, for this reason
  std::string channel = {};  ///< its path: for KeysOutside, MapOutside; NothingMoved by its keys
  std::string told = {};     ///< the words that only its kind needs: why, by what, what to do

  /// One line for an author, frames included.
  std::string message() const;

 private:
  std::string own_message() const;  // without what `is_still` adds
};

/// The word of a kind, for programs: its name, such as `regionTooSmall`.
std::string_view word_of(Warning::Kind kind);

/// The warnings about a scene that need no shape: keys, radii, inertia. Requires: `check_channels`
/// accepts the scene. Cost: a sample of each channel concerned at each frame.
std::vector<Warning> warnings_about(const Scene& scene);

/// The warnings about meshes, caches and maps, and about where forces are, known before any frame;
/// and those of the scene. Requires: the shapes are those of the scene's surfaces. Of long
/// scenes only so many frames are looked at for surfaces that move away from a force: with a cache,
/// whose samples are read for it, and without.
std::vector<Warning> warnings_about(std::span<const RestShape> rest_shapes, const Scene& scene);

inline constexpr int most_cache_frames = 64;
inline constexpr int most_moved_frames = 10'000;

/// Takes away that a force pushes nothing, where another warning says why.
void drop_repeated(std::vector<Warning>& warnings);

/// Adds the surfaces of which it is known before any frame that nothing moves them, and takes away
/// what is then told twice.
void add_still_surfaces(std::vector<Warning>& warnings, const Scene& scene);

/// The same after all frames are played: the surfaces, in the order of the scene, that have not
/// moved. If one of `warnings` is the reason, it tells so; otherwise the surface is added to them.
void add_still_surfaces(std::vector<Warning>& warnings, const Scene& scene,
                        const std::vector<bool>& has_moved);

/// The place of a warning's cause: the force, or an attribute of its surface such as its tangents
/// or start frame.
ScenePlace place_of(const Warning& warning, const SceneOrigin& origin);

}  // namespace pliant
