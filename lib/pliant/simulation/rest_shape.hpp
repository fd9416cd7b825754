#pragma once

#include <string>

#include "pliant/core/memory_budget.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/mesh/grid_mapping.hpp"
#include "pliant/mesh/mesh.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// A surface as it is before anything acts on it.
struct RestShape {
  std::string name;  ///< of the surface
  Mesh mesh;
  GridMapping mapping;
};

/// Makes or reads a surface's mesh and finds its grid. Errors: those of `read_mesh` and
/// `check_mesh`; what `find_grid` finds, at the surface's line in the scene.
///
/// `memory` is sized to what the shape and its body will take, before a sheet is made and once a
/// file is read. Errors, besides: OutOfMemory when the budget has less; Interrupted where
/// `should_stop` says so while assimp reads.
Result<RestShape> make_rest_shape(const Surface& surface, const SceneOrigin& origin,
                                  MemoryShare& memory, const StopRequest& should_stop = {});

/// Whether `make_rest_shape` would succeed; a sheet is not made for it.
Result<void> check_rest_shape(const Surface& surface, const SceneOrigin& origin,
                              MemoryShare& memory, const StopRequest& should_stop = {});

/// The same as the first without a limit to memory.
Result<RestShape> make_rest_shape(const Surface& surface, const SceneOrigin& origin);

}  // namespace pliant
