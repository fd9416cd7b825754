#pragma once

#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/sampling/rest_shape.hpp"

namespace pliant::cli {

/// The largest connected piece of a mesh by area, of the vertices that its faces use: vertices in
/// one place are one, and faces without area do not count.
struct MeshPiece {
  Field vertices;               ///< #vertices x 3, its own [length]
  Field normals;                ///< #vertices x 3: mean of its faces' by area; 0: it has none
  std::vector<bool> is_border;  ///< #vertices: on an edge of one face
  Vector3d low = {0, 0, 0};     ///< corners of the box around its vertices, its own [length]
  Vector3d high = {0, 0, 0};
  bool is_grid = false;  ///< whether the mesh is read as a grid

  double diagonal() const { return (high - low).norm(); }  ///< [length]
};

/// Of a shape without faces that have an area, all its vertices.
MeshPiece largest_piece(const RestShape& shape);

/// The vertex at which a push with this radius moves the piece well: near `wanted`, not on the
/// border, and no nearer to it than the radius if there is such a one. Its row.
Eigen::Index pushed_vertex(const MeshPiece& piece, const Vector3d& wanted, double radius);

}  // namespace pliant::cli
