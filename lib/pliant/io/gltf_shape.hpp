#pragma once

#include <cstdint>
#include <vector>

#include "pliant/mesh/mesh.hpp"

namespace pliant {

// A mesh as graphics hardware wants it: triangles, and one (u,v) and one normal a vertex. Not for
// other rooms.
struct GltfShape {
  /// One material's triangles.
  struct Part {
    int material = -1;  ///< index into the mesh's, -1: none
    std::vector<std::uint32_t> corners;
  };

  // A vertex of the mesh keeps its number. Corners of it that differ in (u,v) or normal from its
  // first one have vertices of their own behind all those of the mesh.
  std::vector<int> source;   ///< #vertices: vertex of the mesh
  std::vector<int> uvs;      ///< #vertices: index into the mesh's (u,v), -1: none
  std::vector<int> normals;  ///< #vertices: number of the mesh's normal, -1: none
  std::vector<Part> parts;   ///< in the order in which the faces first have their materials
};

GltfShape make_gltf_shape(const Mesh& mesh);

}  // namespace pliant
