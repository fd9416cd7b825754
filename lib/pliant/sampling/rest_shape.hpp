#pragma once

#include <string>

#include "pliant/core/memory_budget.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
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

/// A rest shape with the memory that it and its body need, reserved from the run's.
struct ReservedShape {
  RestShape shape;
  MemoryShare memory;
};

/// Makes or reads a surface's mesh and finds its grid. Reserves memory before a sheet is made and
/// after a file is read. Errors: those of `read_mesh` and `check_mesh`; those of `find_grid`, with
/// the surface's line in the scene; OutOfMemory; Interrupted, while assimp reads.
Result<ReservedShape> make_rest_shape(const Surface& surface, const SceneOrigin& origin,
                                      const RunContext& context = {});

/// Checks that `make_rest_shape` would succeed, without making sheets. Returns the memory that it
/// would reserve.
Result<MemoryShare> check_rest_shape(const Surface& surface, const SceneOrigin& origin,
                                     const RunContext& context);

}  // namespace pliant
