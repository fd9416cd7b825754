#include "pliant/mesh/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

namespace pliant {
namespace {

Result<void> check_names(const FaceNames& names, const Mesh& mesh, const char* thing,
                         StopPoll& poll) {
  if (!names.of_faces.empty() && names.of_faces.size() != mesh.face_sizes.size()) {
    return invalid(fmt::format("the list of face {2}s has {0} entries, but the mesh has {1} faces",
                               names.of_faces.size(), mesh.face_sizes.size(), thing));
  }
  for (std::size_t face = 0; face < names.of_faces.size(); ++face) {
    if (poll.after()) return interrupted();
    const int index = names.of_faces[face];
    if (index >= -1 && index < static_cast<std::int64_t>(names.names.size())) continue;
    return invalid(fmt::format("face {} refers to {} {}, but there are {}", face + mesh.first_index,
                               thing, std::int64_t{index} + mesh.first_index, names.names.size()));
  }
  return {};
}

Result<void> check_normals(const Mesh& mesh, StopPoll& poll) {
  if (mesh.corner_normals.empty()) return {};
  if (mesh.corner_normals.size() != mesh.corner_vertices.size()) {
    return invalid(fmt::format("the faces have {} corners, but there are {} corner normals",
                               mesh.corner_vertices.size(), mesh.corner_normals.size()));
  }
  std::vector<bool> is_used;
  for (std::size_t corner = 0; corner < mesh.corner_normals.size(); ++corner) {
    if (poll.after()) return interrupted();
    const int normal = mesh.corner_normals[corner];
    if (normal < 0 || static_cast<std::size_t>(normal) >= mesh.corner_normals.size()) {
      return invalid(fmt::format("corner {} has the normal {}, but there are {} at most",
                                 corner + mesh.first_index, std::int64_t{normal} + mesh.first_index,
                                 mesh.corner_normals.size()));
    }
    if (static_cast<std::size_t>(normal) >= is_used.size())
      is_used.resize(static_cast<std::size_t>(normal) + 1);
    is_used[static_cast<std::size_t>(normal)] = true;
  }
  for (std::size_t normal = 0; normal < is_used.size(); ++normal) {
    if (!is_used[normal])
      return invalid(fmt::format("no corner uses the normal {} of {}", normal + mesh.first_index,
                                 is_used.size()));
  }
  return {};
}

Result<void> check_attributes(const Mesh& mesh, StopPoll& poll) {
  for (const VertexAttribute& attribute : mesh.attributes) {
    if (attribute.values.size() != static_cast<std::size_t>(mesh.vertex_count())) {
      return invalid(fmt::format("the attribute {} has {} values, but the mesh has {} vertices",
                                 printable(attribute.name), attribute.values.size(),
                                 mesh.vertex_count()));
    }
    for (int vertex = 0; vertex < mesh.vertex_count(); ++vertex) {
      if (poll.after()) return interrupted();
      const double value = attribute.values[static_cast<std::size_t>(vertex)];
      if (!std::isfinite(value)) {
        return invalid(fmt::format("vertex {}: the attribute {} is {}, which is not finite",
                                   mesh.number_of(vertex), printable(attribute.name), value));
      }
    }
  }
  return {};
}

}  // namespace

bool operator==(const Mesh& a, const Mesh& b) {
  const auto& [positions, uvs, sizes, vertices, corner_uvs, normals, materials, groups, object,
               left_out, attributes, first, numbers] = b;  // a new member has to be added here
  return are_equal(a.positions, positions) && a.uvs == uvs && a.face_sizes == sizes &&
         a.corner_vertices == vertices && a.corner_uvs == corner_uvs &&
         a.corner_normals == normals && a.materials == materials && a.groups == groups &&
         a.object == object && a.left_out == left_out && a.attributes == attributes &&
         a.first_index == first && a.file_vertices == numbers;
}

void turn_faces(Mesh& mesh) {
  std::ptrdiff_t first = 0;
  for (const int size : mesh.face_sizes) {
    for (std::vector<int>* const corners :
         {&mesh.corner_vertices, &mesh.corner_uvs, &mesh.corner_normals}) {
      if (corners->empty()) continue;  // of the normals
      std::reverse(corners->begin() + first + 1, corners->begin() + first + size);
    }
    first += size;
  }
}

Result<void> check_mesh(const Mesh& mesh, const StopRequest& should_stop) {
  constexpr std::size_t parts_of_row = 4;
  StopPoll poll(should_stop);
  if (mesh.face_sizes.empty()) return invalid("the mesh has no faces");
  if (!mesh.file_vertices.empty() &&
      mesh.file_vertices.size() != static_cast<std::size_t>(mesh.vertex_count())) {
    return invalid(
        fmt::format("the list of vertex numbers has {} entries, but the mesh has {} vertices",
                    mesh.file_vertices.size(), mesh.vertex_count()));
  }
  std::int64_t corners = 0;
  for (std::size_t face = 0; face < mesh.face_sizes.size(); ++face) {
    if (poll.after()) return interrupted();
    const int size = mesh.face_sizes[face];
    if (size < 3)
      return invalid(fmt::format("face {} has {} corners, but needs at least 3",
                                 face + mesh.first_index, size));
    corners += size;
  }
  if (corners != static_cast<std::int64_t>(mesh.corner_vertices.size()) ||
      mesh.corner_uvs.size() != mesh.corner_vertices.size()) {
    return invalid(
        fmt::format("the faces have {} corners, but there are {} corner vertices and {} "
                    "corner uvs",
                    corners, mesh.corner_vertices.size(), mesh.corner_uvs.size()));
  }
  for (std::size_t corner = 0; corner < mesh.corner_vertices.size(); ++corner) {
    if (poll.after(parts_of_row)) return interrupted();
    const int vertex = mesh.corner_vertices[corner];
    const int uv = mesh.corner_uvs[corner];
    if (vertex < 0 || vertex >= mesh.vertex_count()) {
      return invalid(fmt::format("corner {} refers to vertex {}, but there are {}",
                                 corner + mesh.first_index, std::int64_t{vertex} + mesh.first_index,
                                 mesh.vertex_count()));
    }
    if (uv < -1 || uv >= static_cast<std::int64_t>(mesh.uvs.size())) {
      return invalid(fmt::format("corner {} refers to uv {}, but there are {}",
                                 corner + mesh.first_index, std::int64_t{uv} + mesh.first_index,
                                 mesh.uvs.size()));
    }
  }
  for (int vertex = 0; vertex < mesh.vertex_count(); ++vertex) {
    if (poll.after(parts_of_row)) return interrupted();
    if (!mesh.positions.row(vertex).allFinite()) {
      return invalid(
          fmt::format("vertex {} has a coordinate that is not finite", mesh.number_of(vertex)));
    }
  }
  for (std::size_t uv = 0; uv < mesh.uvs.size(); ++uv) {
    if (poll.after(parts_of_row)) return interrupted();
    if (!std::isfinite(mesh.uvs[uv][0]) || !std::isfinite(mesh.uvs[uv][1])) {
      return invalid(fmt::format("uv {} is not finite", uv + mesh.first_index));
    }
  }
  if (auto checked = check_normals(mesh, poll); !checked) return checked;
  if (auto checked = check_attributes(mesh, poll); !checked) return checked;
  if (auto checked = check_names(mesh.materials, mesh, "material", poll); !checked) return checked;
  return check_names(mesh.groups, mesh, "group", poll);
}

}  // namespace pliant
