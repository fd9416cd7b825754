#include "pliant/files/ply/ply_bytes.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "pliant/core/byte_order.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/ply/ply_header.hpp"
#include "pliant/mesh/normals.hpp"

namespace pliant {
namespace {

using Uv = std::array<double, 2>;

// The (u,v) of each vertex; empty if a vertex has none, or several that differ.
std::vector<Uv> vertex_uvs(const Mesh& mesh) {
  std::vector<std::optional<Uv>> found(static_cast<std::size_t>(mesh.vertex_count()));
  for (std::size_t corner = 0; corner < mesh.corner_vertices.size(); ++corner) {
    if (mesh.corner_uvs[corner] < 0) return {};
    const Uv& uv = mesh.uvs[static_cast<std::size_t>(mesh.corner_uvs[corner])];
    auto& of_vertex = found[static_cast<std::size_t>(mesh.corner_vertices[corner])];
    if (of_vertex && *of_vertex != uv) return {};
    of_vertex = uv;
  }
  std::vector<Uv> uvs;
  for (const auto& uv : found) {
    if (!uv) return {};
    uvs.push_back(*uv);
  }
  return uvs;
}

// The same if they are also numbered as the vertices.
std::vector<Uv> numbered_vertex_uvs(const Mesh& mesh) {
  const bool are_same = mesh.uvs.size() == static_cast<std::size_t>(mesh.vertex_count()) &&
                        mesh.corner_uvs == mesh.corner_vertices;
  return are_same ? mesh.uvs : std::vector<Uv>();
}

// The index of each vertex's normal in the mesh; empty if the mesh does not define normals, or a
// vertex has several or none.
std::vector<int> vertex_normals(const Mesh& mesh) {
  if (mesh.corner_normals.empty()) return {};
  std::vector<int> normals(static_cast<std::size_t>(mesh.vertex_count()), -1);
  for (std::size_t corner = 0; corner < mesh.corner_vertices.size(); ++corner) {
    int& of_vertex = normals[static_cast<std::size_t>(mesh.corner_vertices[corner])];
    if (of_vertex >= 0 && of_vertex != mesh.corner_normals[corner]) return {};
    of_vertex = mesh.corner_normals[corner];
  }
  return std::find(normals.begin(), normals.end(), -1) == normals.end() ? normals
                                                                        : std::vector<int>();
}

// Whether a list of a face, with `numbers` entries for each of its corners, is longer than 255.
bool needs_long_counts(const Mesh& mesh, int numbers) {
  return std::any_of(mesh.face_sizes.begin(), mesh.face_sizes.end(),
                     [&](int size) { return std::int64_t{size} * numbers > 255; });
}

bool has_uvs(const Mesh& mesh) {
  return std::any_of(mesh.corner_uvs.begin(), mesh.corner_uvs.end(),
                     [](int uv) { return uv >= 0; });
}

// Whether each corner has its own (u,v), in their order.
bool are_numbered_as_corners(const Mesh& mesh) {
  if (mesh.uvs.size() != mesh.corner_uvs.size()) return false;
  for (std::size_t corner = 0; corner < mesh.corner_uvs.size(); ++corner)
    if (mesh.corner_uvs[corner] != static_cast<int>(corner)) return false;
  return true;
}

}  // namespace

PlyBytes::PlyBytes(const Mesh& mesh, Content content)
    : mesh_(mesh),
      is_exact_(content == Content::Exact),
      uvs_(is_exact_ ? numbered_vertex_uvs(mesh) : vertex_uvs(mesh)),
      uv_kind_(UvKind::None),
      normals_(vertex_normals(mesh)) {
  if (!uvs_.empty()) {
    uv_kind_ = UvKind::OfVertices;
  } else if (is_exact_ && !mesh.uvs.empty()) {
    uv_kind_ = are_numbered_as_corners(mesh) ? UvKind::OfCorners : UvKind::Numbered;
  } else if (has_uvs(mesh)) {
    uv_kind_ = UvKind::OfCorners;
  }
  has_long_counts_ = needs_long_counts(mesh, uv_kind_ == UvKind::OfCorners ? 2 : 1);
}

Result<PlyBytes> PlyBytes::make(const Mesh& mesh, Content content, const StopRequest& should_stop) {
  PlyBytes made(mesh, content);
  made.make_vertices();
  if (!made.make_faces(should_stop)) return interrupted();
  return made;
}

Result<void> PlyBytes::write(const Field& positions, const ByteSink& sink,
                             const StopRequest& should_stop) {
  StopPoll poll(should_stop);
  Result<Field> normals;
  if (!normals_.empty()) normals = unit_normals(mesh_, positions, should_stop);
  if (!normals) return fail(normals.error());
  char* vertex = vertices_.data();
  const std::size_t size = vertex_size();
  for (Eigen::Index row = 0; row < positions.rows(); ++row, vertex += size) {
    if (poll.after(4)) return interrupted();
    const double position[] = {positions(row, 0), positions(row, 1), positions(row, 2)};
    std::memcpy(vertex, position, sizeof(position));
    if (normals_.empty()) continue;
    const int of_vertex = normals_[static_cast<std::size_t>(row)];
    float normal[3];
    for (int k = 0; k < 3; ++k) normal[k] = static_cast<float>((*normals)(of_vertex, k));
    std::memcpy(vertex + sizeof(position), normal, sizeof(normal));
  }
  if (poll.after(0)) return interrupted();
  if (auto written = sink(header()); !written) return written;
  if (auto written = write_in_pieces(vertices_, should_stop, sink); !written) return written;
  return write_in_pieces(faces_, should_stop, sink);
}

std::string PlyBytes::header() const {
  std::string text = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment pliant\nelement vertex {}\n"
      "property double x\nproperty double y\nproperty double z\n{}{}",
      mesh_.vertex_count(),
      normals_.empty() ? "" : "property float nx\nproperty float ny\nproperty float nz\n",
      uvs_.empty() ? "" : "property double s\nproperty double t\n");
  if (is_exact_) {
    for (const VertexAttribute& attribute : mesh_.attributes)
      text += fmt::format("property double {}\n", attribute.name);
  }
  if (uv_kind_ == UvKind::Numbered)
    text += fmt::format("element {} {}\nproperty double u\nproperty double v\n", ply::uv_element,
                        mesh_.uvs.size());
  const std::string_view count = has_long_counts_ ? "uint" : "uchar";
  const auto add_list = [&](std::string_view type, std::string_view name) {
    text += fmt::format("property list {} {} {}\n", count, type, name);
  };
  text += fmt::format("element face {}\n", mesh_.face_sizes.size());
  add_list("int", "vertex_indices");
  if (uv_kind_ == UvKind::OfCorners) add_list(is_exact_ ? "double" : "float", "texcoord");
  if (uv_kind_ == UvKind::Numbered) add_list("int", ply::uv_indices);
  if (is_exact_ && !mesh_.corner_normals.empty()) add_list("int", ply::normal_indices);
  return text + "end_header\n";
}

std::size_t PlyBytes::vertex_size() const {
  return 3 * sizeof(double) + (normals_.empty() ? 0 : 3 * sizeof(float)) +
         (uvs_.empty() ? 0 : sizeof(Uv)) +
         (is_exact_ ? mesh_.attributes.size() * sizeof(double) : 0);
}

// Allocates positions and normals, and fills in what comes after them.
void PlyBytes::make_vertices() {
  const auto count = static_cast<std::size_t>(mesh_.vertex_count());
  const std::size_t size = vertex_size();
  vertices_.resize(size * count);
  const std::size_t begin = 3 * sizeof(double) + (normals_.empty() ? 0 : 3 * sizeof(float));
  for (std::size_t k = 0; k < count; ++k) {
    char* to = vertices_.data() + k * size + begin;
    if (!uvs_.empty()) {
      std::memcpy(to, uvs_[k].data(), sizeof(Uv));
      to += sizeof(Uv);
    }
    for (std::size_t n = 0; is_exact_ && n < mesh_.attributes.size(); ++n, to += sizeof(double))
      std::memcpy(to, &mesh_.attributes[n].values[k], sizeof(double));
  }
}

// Whether all of it is made, which it is unless it is stopped.
bool PlyBytes::make_faces(const StopRequest& should_stop) {
  StopPoll poll(should_stop);
  if (uv_kind_ == UvKind::Numbered) {
    for (const auto& [u, v] : mesh_.uvs) {
      if (poll.after(4)) return false;
      append_number(faces_, u);
      append_number(faces_, v);
    }
  }
  const auto append_indices = [&](const std::vector<int>& all, std::size_t first, std::size_t end) {
    for (std::size_t k = first; k < end; ++k)
      append_number(faces_, static_cast<std::int32_t>(all[k]));
  };
  std::size_t first = 0;
  for (const int face_size : mesh_.face_sizes) {
    const auto size = static_cast<std::size_t>(face_size);
    const std::size_t end = first + size;
    if (poll.after(16 * size)) return false;
    append_count(size);
    append_indices(mesh_.corner_vertices, first, end);
    if (uv_kind_ == UvKind::OfCorners) append_count(2 * size);
    for (std::size_t k = first; k < end && uv_kind_ == UvKind::OfCorners; ++k) {
      const int uv = mesh_.corner_uvs[k];
      for (std::size_t n = 0; n < 2; ++n) {
        const double number = uv < 0 ? 0.0 : mesh_.uvs[static_cast<std::size_t>(uv)][n];
        if (is_exact_) {
          append_number(faces_, number);
        } else {
          append_number(faces_, static_cast<float>(number));
        }
      }
    }
    if (uv_kind_ == UvKind::Numbered) {
      append_count(size);
      append_indices(mesh_.corner_uvs, first, end);
    }
    if (is_exact_ && !mesh_.corner_normals.empty()) {
      append_count(size);
      append_indices(mesh_.corner_normals, first, end);
    }
    first = end;
  }
  return !poll.after(0);
}

void PlyBytes::append_count(std::size_t count) {
  if (has_long_counts_) {
    append_number(faces_, static_cast<std::uint32_t>(count));
  } else {
    append_number(faces_, static_cast<std::uint8_t>(count));
  }
}

bool is_ply_attribute(const std::string& name) {
  const std::string_view place[] = {"x", "y", "z"};
  const auto is_among = [&](const auto& names) {
    return std::ranges::find(names, name) != std::end(names);
  };
  return !name.empty() && name.find_first_of(ascii_blanks) == std::string::npos &&
         !is_among(place) && !is_among(ply::normal_names) &&
         std::ranges::none_of(ply::uv_names, is_among);
}

}  // namespace pliant
