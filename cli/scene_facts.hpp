#pragma once

#include <string>
#include <vector>

#include "pliant/pliant.hpp"

namespace pliant::cli {

/// The corners of what encloses some points. [length]
struct BoundingBox {
  Vector3d low;
  Vector3d high;
};

/// What `pliant info` tells of a scene. Refers to the scene.
struct SceneFacts {
  std::string file;  ///< as the caller named it
  const Scene& scene;

  /// Of each surface in the order of the scene; empty without surfaces.
  struct SurfaceFacts {
    Grid grid;
    std::size_t vertex_count = 0;
    BoundingBox placed;  ///< in the world, at the first frame
    BoundingBox own;     ///< before its transform
  };
  std::vector<SurfaceFacts> surfaces = {};
  std::vector<Preview> previews = {};
  std::size_t surface_memory = 0;  ///< [bytes]
  std::size_t solver_memory = 0;   ///< of the largest region previewed [bytes]
};

/// Why a force has no preview: "never enabled", or that no surface is solved while it is.
std::string idle_reason(const Force& force, const Scene& scene);

}  // namespace pliant::cli
