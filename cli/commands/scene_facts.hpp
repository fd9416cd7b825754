#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pliant/pliant.hpp"

namespace pliant::cli {

/// Two opposite corners of a box around points, parallel to the axes. [length]
struct BoundingBox {
  Vector3d low;
  Vector3d high;
};

/// The facts that `pliant info` prints about a scene. Refers to the scene.
struct SceneFacts {
  std::string file;  ///< the name given by the caller
  const Scene& scene;

  /// One for each surface, in the order of the scene.
  struct SurfaceFacts {
    std::optional<Grid> grid;  ///< null: a surface of triangles
    std::optional<SurfaceSummary> triangles;
    std::size_t vertex_count = 0;
    BoundingBox placed;  ///< in the world, at the first frame
    BoundingBox own;     ///< before its transform and its cache
    std::optional<CacheSummary> cache = {};
    std::vector<MapSummary> maps = {};
    std::size_t held_nodes = 0;  ///< by a <hold>
  };
  std::vector<SurfaceFacts> surfaces = {};
  std::vector<Preview> previews = {};
  std::vector<ContactSummary> contacts = {};
  bool is_contact_played = false;            ///< false: too many frames and nodes, or no cycle
  std::optional<Error> no_first_frame = {};  ///< why there is none: a loop closes to no cycle
  std::vector<Warning> warnings = {};        ///< that need no frame
  std::size_t surface_memory = 0;            ///< [bytes]
  std::size_t solver_memory = 0;             ///< of the largest region previewed [bytes]
};

/// The previews of a kind: a list for each force, for each group, or one of all together.
using PreviewLists = std::vector<std::vector<const Preview*>>;
PreviewLists previews_of(const SceneFacts& facts, Preview::Of of);

/// The forces of each group, by their index in the scene.
std::vector<std::vector<std::size_t>> members_of_groups(const Scene& scene);

/// Why each force has no preview: "never enabled", or that no surface is solved while it is
/// enabled. Empty: it has one.
std::vector<std::string> idle_reasons(const SceneFacts& facts);

}  // namespace pliant::cli
