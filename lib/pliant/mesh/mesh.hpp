#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"

namespace pliant {

/// Names that faces carry: of materials, of groups.
struct FaceNames {
  std::vector<std::string> names;  ///< in the order in which the faces first carry them
  std::vector<int> of_faces;       ///< #faces: index into `names`, -1: none; empty: none at all

  friend bool operator==(const FaceNames&, const FaceNames&) = default;
};

/// A polygon mesh with (u,v) at the corners of its faces, in the order in which its author gave it.
struct Mesh {
  Field positions;                         ///< #vertices x 3, object space [length]
  std::vector<std::array<double, 2>> uvs;  ///< (u,v) pairs that the corners refer to [uv]
  std::vector<int> face_sizes;             ///< #faces: corners of each face, >= 3
  std::vector<int> corner_vertices;        ///< #corners: row of `positions`
  std::vector<int> corner_uvs;             ///< #corners: index into `uvs`, -1: the corner has none

  /// #corners: corners of the same number share a normal, the numbers being 0 to count - 1. Empty:
  /// the corners of each vertex do, so that the surface is smooth.
  std::vector<int> corner_normals = {};

  FaceNames materials = {};
  FaceNames groups = {};
  std::string object = {};  ///< its name in the file that it was read from

  int first_index = 0;  ///< from which its file counts, and so messages do: OBJ from 1

  /// #vertices: which of its file's, from 0, each is; empty: the same one.
  std::vector<int> file_vertices = {};

  /// A vertex as its author counts.
  int number_of(int vertex) const {
    return first_index +
           (file_vertices.empty() ? vertex : file_vertices[static_cast<std::size_t>(vertex)]);
  }

  int vertex_count() const { return static_cast<int>(positions.rows()); }
};

/// Whether a mesh that a program made keeps what its members say.
/// Errors, naming the face, corner or vertex, counted from `first_index`: index arrays of different
/// lengths, faces with fewer than three corners, indices out of range, coordinates that are not
/// finite, no faces; numbers of normals with a gap; numbers of vertices for a part of them.
Result<void> check_mesh(const Mesh& mesh);

}  // namespace pliant
