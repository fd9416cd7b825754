#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/files/byte_sink.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// A mesh as binary PLY, little-endian: `double x y z` of each vertex and the faces as in the
/// source, with `float nx ny nz` if the mesh defines which corners share a normal and each vertex
/// has only one. (u,v) are `double s t` of the vertices or a list `texcoord` of each face.
class PlyBytes {
 public:
  enum class Content {
    /// What other programs read: `s t` if each vertex has only one (u,v) over all its corners,
    /// otherwise `texcoord` in single precision.
    Common,
    /// All that `read_ply` makes the same mesh of, but for what it tells of a file, and materials
    /// and groups: (u,v) as they are numbered, if need be by an element `texcoord` and a list
    /// `texcoord_indices` of each face; which corners share a normal, as `normal_indices`; and
    /// attributes as `double` of the vertices.
    Exact,
  };

  /// Of a mesh, which must outlive it. Errors: Interrupted.
  static Result<PlyBytes> make(const Mesh& mesh, Content content,
                               const StopRequest& should_stop = {});

  /// The mesh with its vertices at `positions`. Errors: those of the sink; Interrupted.
  Result<void> write(const Field& positions, const ByteSink& sink,
                     const StopRequest& should_stop = {});

 private:
  using Uv = std::array<double, 2>;

  // How the file has (u,v).
  enum class UvKind { None, OfVertices, OfCorners, Numbered };

  PlyBytes(const Mesh& mesh, Content content);
  std::string header() const;
  std::size_t vertex_size() const;
  void make_vertices();
  bool make_faces(const StopRequest& should_stop);
  void append_count(std::size_t count);

  const Mesh& mesh_;
  bool is_exact_;
  std::vector<Uv> uvs_;  // of the vertices, if they have them
  UvKind uv_kind_;
  std::vector<int> normals_;  // of the vertices, if each has one
  bool has_long_counts_;
  // Everything but positions and normals is the same in every frame.
  std::string vertices_;
  std::string faces_;  // with the (u,v) that they refer to
};

/// Whether the vertices of a PLY may have an attribute of that name: one word, which has no other
/// meaning there.
bool is_ply_attribute(const std::string& name);

}  // namespace pliant
