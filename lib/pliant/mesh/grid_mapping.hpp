#pragma once

#include <string>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/grid.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// The node of a uniform (u,v) grid for each vertex of a mesh. Found from the (u,v) values, never
/// from the order of the vertices, which thesis 4.3 still requires to be sorted. Vertices that
/// share a node move together.
struct GridMapping {
  Grid grid;
  std::vector<int> vertex_nodes;  ///< #vertices: the node of each vertex
  Field rest;                     ///< #nodes x 3: rest positions, object space [length]
};

/// Largest distance of a u (v) from its lattice value, in spacings, for a lattice to be uniform.
inline constexpr double lattice_tolerance = 1e-2;

/// What nodes in one place are at rest.
enum class Seams {
  Refused,  ///< a sign that the mesh is closed there, so that it is no grid
  Open,     ///< two nodes that stay apart: the mesh is cut there
};

/// Finds the grid of a mesh: hu = (u_max - u_min) / (columns - 1), likewise hv; a node is the
/// lattice point within `lattice_tolerance` spacings. SPEC 1. Errors, naming the vertex as its file
/// counts: a vertex without (u,v); one with (u,v) of several nodes (a seam); a lattice that is not
/// uniform, has empty nodes, or fewer than 3 of them in a direction; vertices of one node with
/// different rest positions; unless seams are open, nodes at the same rest position (on the border
/// within 1e-6 of the bounding box's diagonal, elsewhere exactly), which is how formats that split
/// vertices store a seam.
///
/// With `wrap` the first and last column (row) of the lattice are one, so that the grid has one
/// less: (u,v) that differ by the whole range are one node. Errors also: their vertices are further
/// apart than 1e-6 of the diagonal; a pole, which is a row (column) across the closed direction
/// with all its nodes in one place; Interrupted.
Result<GridMapping> find_grid(const Mesh& mesh, Wrap wrap = Wrap::None,
                              Seams seams = Seams::Refused, const StopRequest& should_stop = {});

}  // namespace pliant
