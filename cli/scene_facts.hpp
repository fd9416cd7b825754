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
  };
  std::vector<SurfaceFacts> surfaces = {};
  std::vector<Preview> previews = {};
  std::optional<Error> no_first_frame = {};  ///< why there is none: a loop closes to no cycle
  std::size_t surface_memory = 0;            ///< [bytes]
  std::size_t solver_memory = 0;             ///< of the largest region previewed [bytes]
};

/// Why a force has no preview: "never enabled", or that no surface is solved while it is enabled.
std::string idle_reason(const Force& force, const Scene& scene);

}  // namespace pliant::cli
