#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant {

/// Names of faces: of materials or of groups.
struct FaceNames {
  std::vector<std::string> names;  ///< in the order of their first use by a face
  std::vector<int> of_faces;       ///< #faces: index into `names`, -1: none; empty: no names

  friend bool operator==(const FaceNames&, const FaceNames&) = default;
};

/// A number at each vertex of a mesh.
struct VertexAttribute {
  std::string name;
  std::vector<double> values;  ///< #vertices, finite

  friend bool operator==(const VertexAttribute&, const VertexAttribute&) = default;
};

/// A polygon mesh with (u,v) at the corners of its faces, in the order of its author.
struct Mesh {
  Field positions;                         ///< #vertices x 3, object space [length]
  std::vector<std::array<double, 2>> uvs;  ///< (u,v) pairs, referred to by the corners [uv]
  std::vector<int> face_sizes;             ///< #faces: corners of each face, >= 3
  std::vector<int> corner_vertices;        ///< #corners: row of `positions`
  std::vector<int> corner_uvs;             ///< #corners: index into `uvs`, -1: the corner has none

  /// #corners: corners of the same number share a normal; the numbers are 0 to count - 1. Empty:
  /// the corners of each vertex share one, so that the surface is smooth.
  std::vector<int> corner_normals = {};

  FaceNames materials = {};
  FaceNames groups = {};
  std::string object = {};  ///< its name in the file

  /// What its file has and the mesh lacks, with counts: `1 line and 3 points`; empty: nothing.
  std::string left_out = {};

  /// Numbers at the vertices, for maps of the material. Of a file: those asked for.
  std::vector<VertexAttribute> attributes = {};

  int first_index = 0;  ///< first vertex number of its file, used in messages: 1 for OBJ

  /// #vertices: the index of each in its file, from 0; empty: its own index.
  std::vector<int> file_vertices = {};

  /// The number of a vertex in its file.
  int number_of(int vertex) const {
    return first_index +
           (file_vertices.empty() ? vertex : file_vertices[static_cast<std::size_t>(vertex)]);
  }

  int vertex_count() const { return static_cast<int>(positions.rows()); }

  friend bool operator==(const Mesh& a, const Mesh& b);
};

/// Turns every face the other way round: its corners in the opposite order, from the same first one
/// on.
void turn_faces(Mesh& mesh);

/// Whether a mesh made by a program fulfils the comments on its members. Errors, naming the face,
/// corner or vertex, counted from `first_index`: index arrays of different lengths, faces with
/// fewer than three corners, indices out of range, coordinates or attributes that are not finite,
/// no faces; numbers of normals with a gap; numbers or attributes of vertices for only a part of
/// them; Interrupted.
Result<void> check_mesh(const Mesh& mesh, const StopRequest& should_stop = {});

}  // namespace pliant
