#include "pliant/output/gltf_shape.hpp"

#include <algorithm>
#include <array>

#include "pliant/mesh/normals.hpp"
#include "pliant/mesh/triangulate.hpp"

namespace pliant {
namespace {

constexpr int none = -1;

// Finds the vertex with the (u,v) and normal of a corner, or creates it.
class Splitter {
 public:
  Splitter(const Mesh& mesh, GltfShape& shape) : mesh_(mesh), shape_(shape) {
    const auto count = static_cast<std::size_t>(mesh.vertex_count());
    for (std::size_t k = 0; k < count; ++k) shape.source.push_back(static_cast<int>(k));
    shape.uvs.assign(count, none);
    shape.normals.assign(count, none);
    next_.assign(count, none);
    is_used_.assign(count, false);
  }

  std::uint32_t vertex_of(std::size_t corner) {
    const int uv = mesh_.corner_uvs[corner];
    const int normal = normal_of(mesh_, corner);
    int vertex = mesh_.corner_vertices[corner];
    if (!is_used_[static_cast<std::size_t>(vertex)]) {
      is_used_[static_cast<std::size_t>(vertex)] = true;
      set(vertex, uv, normal);
      return static_cast<std::uint32_t>(vertex);
    }
    while (!has(vertex, uv, normal)) {
      const int next = next_[static_cast<std::size_t>(vertex)];
      if (next == none) return static_cast<std::uint32_t>(add_behind(vertex, uv, normal));
      vertex = next;
    }
    return static_cast<std::uint32_t>(vertex);
  }

 private:
  bool has(int vertex, int uv, int normal) const {
    const int own = shape_.uvs[static_cast<std::size_t>(vertex)];
    if (shape_.normals[static_cast<std::size_t>(vertex)] != normal) return false;
    if (own == uv) return true;
    return own >= 0 && uv >= 0 &&
           mesh_.uvs[static_cast<std::size_t>(own)] == mesh_.uvs[static_cast<std::size_t>(uv)];
  }

  void set(int vertex, int uv, int normal) {
    shape_.uvs[static_cast<std::size_t>(vertex)] = uv;
    shape_.normals[static_cast<std::size_t>(vertex)] = normal;
  }

  int add_behind(int vertex, int uv, int normal) {
    const auto added = static_cast<int>(shape_.source.size());
    shape_.source.push_back(shape_.source[static_cast<std::size_t>(vertex)]);
    shape_.uvs.push_back(uv);
    shape_.normals.push_back(normal);
    next_.push_back(none);
    next_[static_cast<std::size_t>(vertex)] = added;
    return added;
  }

  const Mesh& mesh_;
  GltfShape& shape_;
  std::vector<int> next_;  // the next vertex split off from the same one
  std::vector<bool> is_used_;
};

}  // namespace

GltfShape make_gltf_shape(const Mesh& mesh) {
  GltfShape shape;
  Splitter splitter(mesh, shape);
  std::vector<std::uint32_t> corners;
  for (std::size_t corner = 0; corner < mesh.corner_vertices.size(); ++corner)
    corners.push_back(splitter.vertex_of(corner));

  const std::vector<std::array<int, 3>> triangles = triangulate(mesh);
  std::vector<std::size_t> part_of(mesh.materials.names.size() + 1, 0);  // counted from 1
  std::size_t triangle = 0;
  for (std::size_t face = 0; face < mesh.face_sizes.size(); ++face) {
    const int material = mesh.materials.of_faces.empty() ? none : mesh.materials.of_faces[face];
    std::size_t& part = part_of[static_cast<std::size_t>(std::int64_t{material} + 1)];
    if (part == 0) {
      shape.parts.push_back({material, {}});
      part = shape.parts.size();
    }
    for (int k = 0; k < mesh.face_sizes[face] - 2; ++k, ++triangle) {
      for (const int corner : triangles[triangle])
        shape.parts[part - 1].corners.push_back(corners[static_cast<std::size_t>(corner)]);
    }
  }
  return shape;
}

}  // namespace pliant
