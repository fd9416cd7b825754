#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

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
  };
  Kind kind = Kind::RegionTooSmall;
  std::string surface;  ///< empty: all, for a force that selects nothing on any surface
  std::string force;    ///< or group; empty: the warning is about the surface itself
  FrameRanges frames;
  std::vector<std::string> others = {};    ///< for ForcesApart: the forces besides `force`
  bool is_group = false;                   ///< whether `force` is the region of a group
  int faces = 0;                           ///< for FacesLeftOut
  std::string left_out = {};               ///< for FileLeftOut: `Mesh::left_out`
  std::optional<CacheSummary> cache = {};  ///< for CacheOutside
  bool is_cache_late = false;              ///< whether the samples are after the scene's frames
  /// Whether it tells of frames that lack some of the scene's, which were not played: there what
  /// never happened may still happen.
  bool is_of_part = false;

  /// One line for an author, frames included.
  std::string message() const;
};

/// The warnings about meshes and caches, known before any frame. Requires: the shapes are those of
/// the scene's surfaces.
std::vector<Warning> warnings_about(std::span<const RestShape> rest_shapes, const Scene& scene);

/// The place of a warning's cause: the force, or an attribute of its surface such as its tangents
/// or start frame.
TextPlace place_of(const Warning& warning, const SceneOrigin& origin);

}  // namespace pliant
