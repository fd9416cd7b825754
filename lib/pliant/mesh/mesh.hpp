#pragma once

#include <array>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"

namespace pliant {

/// A polygon mesh with (u,v) at the corners of its faces, in the order in which its author gave it.
struct Mesh {
  Field positions;                         ///< #vertices x 3, object space [length]
  std::vector<std::array<double, 2>> uvs;  ///< (u,v) pairs that the corners refer to [uv]
  std::vector<int> face_sizes;             ///< #faces: corners of each face, >= 3
  std::vector<int> corner_vertices;        ///< #corners: row of `positions`
  std::vector<int> corner_uvs;             ///< #corners: index into `uvs`, -1: the corner has none

  int vertex_count() const { return static_cast<int>(positions.rows()); }
};

/// Whether a mesh that a program made keeps what its members say.
/// Errors, naming the face, corner or vertex, counted from 1: index arrays of different lengths,
/// faces with fewer than three corners, indices out of range, coordinates that are not finite, no
/// faces.
Result<void> check_mesh(const Mesh& mesh);

}  // namespace pliant
