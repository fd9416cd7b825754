#pragma once

#include <string>

#include "pliant/core/memory_budget.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/mesh/grid_mapping.hpp"
#include "pliant/mesh/mesh.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// A surface before any force acts on it.
struct RestShape {
  std::string name;  ///< of the surface
  Mesh mesh;
  GridMapping mapping;
};

/// Makes or reads a surface's mesh and finds its grid. Errors: those of `read_mesh` and
/// `check_mesh`; those of `find_grid`, with the surface's line in the scene.
///
/// `memory` is resized to the needs of the shape and its body, before a sheet is made or after a
/// file is read. Further errors: OutOfMemory if the budget has less; Interrupted if `should_stop`
/// returns true while assimp reads.
Result<RestShape> make_rest_shape(const Surface& surface, const SceneOrigin& origin,
                                  MemoryShare& memory, const StopRequest& should_stop = {});

/// Checks that `make_rest_shape` would succeed, without making sheets.
Result<void> check_rest_shape(const Surface& surface, const SceneOrigin& origin,
                              MemoryShare& memory, const StopRequest& should_stop = {});

/// The first function without a limit to memory.
Result<RestShape> make_rest_shape(const Surface& surface, const SceneOrigin& origin);

}  // namespace pliant
