#include "pliant/mesh/mesh.hpp"

#include <cmath>
#include <cstdint>

#include <fmt/format.h>

namespace pliant {

Result<void> check_mesh(const Mesh& mesh) {
  const auto broken = [](std::string message) {
    return fail(ErrorCode::InvalidInput, std::move(message));
  };
  if (mesh.face_sizes.empty()) return broken("the mesh has no faces");
  std::int64_t corners = 0;
  for (std::size_t face = 0; face < mesh.face_sizes.size(); ++face) {
    const int size = mesh.face_sizes[face];
    if (size < 3)
      return broken(fmt::format("face {} has {} of at least 3 corners", face + 1, size));
    corners += size;
  }
  if (corners != static_cast<std::int64_t>(mesh.corner_vertices.size()) ||
      mesh.corner_uvs.size() != mesh.corner_vertices.size()) {
    return broken(
        fmt::format("the faces have {} corners, but there are {} corner vertices and {} "
                    "corner uvs",
                    corners, mesh.corner_vertices.size(), mesh.corner_uvs.size()));
  }
  for (std::size_t corner = 0; corner < mesh.corner_vertices.size(); ++corner) {
    const int vertex = mesh.corner_vertices[corner];
    const int uv = mesh.corner_uvs[corner];
    if (vertex < 0 || vertex >= mesh.vertex_count()) {
      return broken(fmt::format("corner {} refers to vertex {} of {}", corner + 1, vertex + 1,
                                mesh.vertex_count()));
    }
    if (uv < -1 || uv >= static_cast<std::int64_t>(mesh.uvs.size())) {
      return broken(
          fmt::format("corner {} refers to uv {} of {}", corner + 1, uv + 1, mesh.uvs.size()));
    }
  }
  for (int vertex = 0; vertex < mesh.vertex_count(); ++vertex) {
    if (!mesh.positions.row(vertex).allFinite()) {
      return broken(fmt::format("vertex {} has a coordinate that is not finite", vertex + 1));
    }
  }
  for (std::size_t uv = 0; uv < mesh.uvs.size(); ++uv) {
    if (!std::isfinite(mesh.uvs[uv][0]) || !std::isfinite(mesh.uvs[uv][1])) {
      return broken(fmt::format("uv {} is not finite", uv + 1));
    }
  }
  return {};
}

}  // namespace pliant
