#pragma once

#include <cstdint>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

// A mesh in the form that graphics hardware needs: triangles, and one (u,v) and one normal per
// vertex. Internal to output.
struct GltfShape {
  /// One material's triangles.
  struct Primitive {
    int material = -1;  ///< index into the mesh's, -1: none
    std::vector<std::uint32_t> corners;
  };

  // A vertex of the mesh keeps its index. Its corners whose (u,v) or normal differ from its first
  // corner's have vertices of their own, after all those of the mesh.
  std::vector<int> source;            ///< #vertices: vertex of the mesh
  std::vector<int> uvs;               ///< #vertices: index into the mesh's (u,v), -1: none
  std::vector<int> normals;           ///< #vertices: index of the mesh's normal, -1: none
  std::vector<Primitive> primitives;  ///< in the order of the materials' first use by a face
};

/// Errors: Interrupted. Cost: that of `triangulate`, and n log n in the corners.
Result<GltfShape> make_gltf_shape(const Mesh& mesh, const StopRequest& should_stop = {});

}  // namespace pliant
