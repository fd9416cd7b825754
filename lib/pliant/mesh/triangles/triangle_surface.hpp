#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/core/triangle_cells.hpp"
#include "pliant/mesh/mesh.hpp"
#include "pliant/mesh/mesh_reading.hpp"
#include "pliant/mesh/node_faces.hpp"

namespace pliant {

/// A mesh as the triangles of a plate that bends along it, at rest: its vertices joined to nodes,
/// its faces cut into triangles, each with its directions u and v. docs/model.md, "Surfaces".
///
/// A face of three corners is one triangle. A face of n > 3 corners has a centre, the mean of its
/// corners, and n triangles (corner, next corner, centre).
struct TriangleSurface : NodeFaces {  // the faces that take part, in their order in the mesh
  std::vector<int> vertex_nodes;      ///< #vertices: the node of each; -1: it is in no face
  Field rest;                         ///< #nodes x 3: of the lowest vertex, object space [length]

  std::vector<int> triangle_starts;  ///< #faces + 1: its first triangle
  std::vector<int> corner_edges;     ///< #corners: the edge from a corner to the next
  std::vector<int> mesh_corners;     ///< #corners: the mesh's, counted over all its faces
  std::vector<int> edge_sides;       ///< #edges: the sides of faces that lie there
  std::vector<FlatTriangle> triangles;

  std::array<double, 2> unit = {1, 1};  ///< as in `MeshReading` [length/uv]
  int faces_left_out = 0;               ///< that take no part
  double widest_face = 0;               ///< no two corners of a face are farther apart [length]

  int node_count() const { return static_cast<int>(rest.rows()); }
  int edge_count() const { return static_cast<int>(edge_sides.size()); }

  bool has_centre(int face) const { return size_of(face) > 3; }
  std::span<const int> edges_of(int face) const {
    return {corner_edges.data() + face_starts[face], static_cast<std::size_t>(size_of(face))};
  }
};

/// Reads a mesh as a surface. A face takes no part if fewer than three of its corners are left once
/// repeated ones are dropped, if it has a node twice, or the nodes of an earlier face. Requires:
/// `check_mesh` accepts the mesh; `reading` has the ranges of its comments. Errors: no face takes
/// part; an edge belongs to more than 256 faces; the surface has no area, or lengths that are not
/// finite; Interrupted.
Result<TriangleSurface> make_surface(const Mesh& mesh, const MeshReading& reading = {},
                                     const StopRequest& should_stop = {});

/// The same with nodes that are known, such as those of a grid: `rest` (#nodes x 3) and the node of
/// each vertex in a face.
Result<TriangleSurface> surface_of_nodes(const Mesh& mesh, std::vector<int> vertex_nodes,
                                         Field rest, const StopRequest& should_stop = {});

/// #nodes: the piece of the mesh that each belongs to, faces joined by shared corners, counted in
/// the order of their first nodes; -1: no face of the node takes part.
std::vector<int> pieces_of(const TriangleSurface& surface);

/// The same surface with its nodes in other places (#nodes x 3). Its triangles keep their shapes.
TriangleSurface posed(TriangleSurface surface, const Field& nodes);

}  // namespace pliant
