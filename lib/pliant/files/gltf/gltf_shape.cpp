#include "pliant/files/gltf/gltf_shape.hpp"

#include <array>
#include <cstddef>
#include <numeric>

#include "pliant/mesh/normals.hpp"
#include "pliant/mesh/triangles/equal_numbers.hpp"
#include "pliant/mesh/triangles/triangulate.hpp"

namespace pliant {
namespace {

constexpr int none = -1;

// Makes the vertices of a shape. Returns that of each corner of the mesh; unfinished if it is
// stopped.
std::vector<std::uint32_t> split_vertices(const Mesh& mesh, GltfShape& shape, StopPoll& poll) {
  const std::vector<int> uv_numbers = numbers_of_equal(mesh.uvs, poll);
  std::vector<std::array<int, 3>> keys;  // corners with the same one share their vertex
  keys.reserve(mesh.corner_vertices.size());
  for (std::size_t corner = 0; corner < mesh.corner_vertices.size(); ++corner) {
    const int uv = mesh.corner_uvs[corner];
    keys.push_back({mesh.corner_vertices[corner], normal_of(mesh, corner),
                    uv < 0 ? none : uv_numbers[static_cast<std::size_t>(uv)]});
  }
  shape.source.resize(static_cast<std::size_t>(mesh.vertex_count()));
  std::iota(shape.source.begin(), shape.source.end(), 0);
  shape.uvs.assign(shape.source.size(), none);
  shape.normals.assign(shape.source.size(), none);
  std::vector<bool> is_used(shape.source.size());
  const std::vector<int> numbers = numbers_of_equal(keys, poll);
  std::vector<int> vertices;  // of each number
  std::vector<std::uint32_t> corners;
  if (poll.after(0)) return corners;
  corners.reserve(keys.size());
  for (std::size_t corner = 0; corner < keys.size(); ++corner) {
    if (poll.after(16)) return corners;
    if (static_cast<std::size_t>(numbers[corner]) == vertices.size()) {
      int vertex = mesh.corner_vertices[corner];
      if (is_used[static_cast<std::size_t>(vertex)]) {
        shape.source.push_back(vertex);
        vertex = static_cast<int>(shape.source.size()) - 1;
        shape.uvs.push_back(none);
        shape.normals.push_back(none);
      } else {
        is_used[static_cast<std::size_t>(vertex)] = true;
      }
      shape.uvs[static_cast<std::size_t>(vertex)] = mesh.corner_uvs[corner];
      shape.normals[static_cast<std::size_t>(vertex)] = keys[corner][1];
      vertices.push_back(vertex);
    }
    corners.push_back(
        static_cast<std::uint32_t>(vertices[static_cast<std::size_t>(numbers[corner])]));
  }
  return corners;
}

}  // namespace

Result<GltfShape> make_gltf_shape(const Mesh& mesh, const StopRequest& should_stop) {
  StopPoll poll(should_stop);
  GltfShape shape;
  const std::vector<std::uint32_t> corners = split_vertices(mesh, shape, poll);
  const std::vector<std::array<int, 3>> triangles = triangulate(mesh, poll);
  if (poll.after(0)) return interrupted();

  std::vector<std::size_t> primitive_of(mesh.materials.names.size() + 1, 0);  // counted from 1
  std::size_t triangle = 0;
  for (std::size_t face = 0; face < mesh.face_sizes.size(); ++face) {
    const int material = mesh.materials.of_faces.empty() ? none : mesh.materials.of_faces[face];
    std::size_t& primitive = primitive_of[static_cast<std::size_t>(std::int64_t{material} + 1)];
    if (primitive == 0) {
      shape.primitives.push_back({material, {}});
      primitive = shape.primitives.size();
    }
    if (poll.after(4 * static_cast<std::size_t>(mesh.face_sizes[face]))) return interrupted();
    for (int k = 0; k < mesh.face_sizes[face] - 2; ++k, ++triangle) {
      for (const int corner : triangles[triangle])
        shape.primitives[primitive - 1].corners.push_back(
            corners[static_cast<std::size_t>(corner)]);
    }
  }
  return shape;
}

}  // namespace pliant
