#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/grid.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/mesh/mesh.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

struct TriangleSurface;

/// A surface before any force acts on it: its mesh, and the nodes that are simulated.
struct RestShape {
  std::string name;  ///< of the surface
  Mesh mesh;
  std::vector<int> vertex_nodes;  ///< #vertices: the node of each; -1: it never moves
  Field rest;                     ///< #nodes x 3: rest positions, object space [length]

  /// The grid of the nodes; none: they are a surface of triangles.
  std::optional<Grid> grid = {};
  std::shared_ptr<const TriangleSurface> surface = {};  ///< null: a grid
  std::string note = {};  ///< a remark for the author on how the mesh was read; may be empty

  /// The vertices for positions of the nodes (#nodes x 3 -> #vertices x 3), in the memory of
  /// `reuse`. Vertices of one node keep their offsets from each other.
  Field to_vertices(const Field& nodes, Field reuse = {}) const;
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
