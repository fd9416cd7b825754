#pragma once

#include <string>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/grid.hpp"
#include "pliant/core/result.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// Which node of an even (u,v) grid each vertex of a mesh is. Found from the (u,v) values, never
/// from the order of the vertices, which thesis 4.3 still needs sorted. Vertices that share a node
/// move together.
struct GridMapping {
  Grid grid;
  std::vector<int> vertex_nodes;  ///< #vertices: the node of each vertex
  Field rest;                     ///< #nodes x 3: rest positions, object space [length]

  /// A field over the nodes (#nodes x 3) taken to the vertices (#vertices x 3), in the memory of
  /// `reuse`.
  Field to_vertices(const Field& nodes, Field reuse = {}) const;
};

/// Largest distance of a u (v) from its lattice value, in spacings, that still counts as even.
inline constexpr double lattice_tolerance = 1e-2;

/// Finds the grid of a mesh: hu = (u_max - u_min) / (columns - 1), likewise hv; a node is the
/// lattice point within `lattice_tolerance` spacings. SPEC 1. Errors, naming the vertex as its file
/// counts: a vertex without (u,v); one with (u,v) of several nodes (a seam); a lattice that is not
/// even, has empty nodes, or fewer than 3 of them in a direction; vertices of one node with
/// different rest positions; nodes in one place at rest, on the border within 1e-6 of the bounding
/// box's diagonal, elsewhere exactly, which is how formats that split vertices have a seam.
Result<GridMapping> find_grid(const Mesh& mesh);

}  // namespace pliant
