#pragma once

#include <span>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// The faces of a surface as lists of its nodes, and the faces around each node.
struct NodeFaces {
  std::vector<int> face_starts;   ///< #faces + 1: its first corner, counted over all faces
  std::vector<int> corner_nodes;  ///< #corners

  // The faces around each node, ascending: node_faces[node_starts[k]] to the start of the next.
  std::vector<int> node_starts;  ///< #nodes + 1
  std::vector<int> node_faces;

  /// The columns of nodes, if the faces are the cells of an open grid, row by row; otherwise 0.
  int grid_columns = 0;
  bool is_turned = false;  ///< whether such a cell goes round from u to -v, not to v

  int face_count() const { return static_cast<int>(face_starts.size()) - 1; }
  int size_of(int face) const { return face_starts[face + 1] - face_starts[face]; }
  std::span<const int> nodes_of(int face) const {
    return {corner_nodes.data() + face_starts[face], static_cast<std::size_t>(size_of(face))};
  }
  std::span<const int> faces_of(int node) const {
    return {node_faces.data() + node_starts[node],
            static_cast<std::size_t>(node_starts[node + 1] - node_starts[node])};
  }
};

/// Lists the faces of each node from the nodes of each face. Unfinished if it is stopped.
void list_faces_of_nodes(NodeFaces& faces, int node_count, StopPoll& poll);

/// The faces of a mesh with the node of each vertex, -1: none; one with fewer than three nodes has
/// none. Errors: Interrupted.
Result<NodeFaces> node_faces(const Mesh& mesh, const std::vector<int>& vertex_nodes, int node_count,
                             const StopRequest& should_stop = {});

/// The unit normal of a node: the sum of the vector areas of its faces, those of polygons by
/// Newell's rule, times `to_normals`. 0 where it is below 1e-12 of the sum of the areas.
/// `positions`: of the nodes (#nodes x 3). SPEC 7.
Vector3d normal_at(const NodeFaces& faces, const Field& positions, const Matrix3d& to_normals,
                   int node);

/// Where the normals of a run of nodes go, component by component.
struct NormalRun {
  double* x;
  double* y;
  double* z;
};

/// The most nodes of a run.
inline constexpr int most_normals = 32;

/// `normal_at` of `count` nodes from node `first` on, with the same bits. Requires: 0 <= count <=
/// most_normals.
void normals_of_run(const NodeFaces& faces, const Field& positions, const Matrix3d& to_normals,
                    int first, int count, const NormalRun& out);

}  // namespace pliant
