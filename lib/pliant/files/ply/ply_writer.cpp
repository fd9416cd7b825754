#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/byte_order.hpp"
#include "pliant/files/formats.hpp"
#include "pliant/files/sequence.hpp"
#include "pliant/files/written_mesh.hpp"
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

class PlyWriter final : public SequenceWriter {
 public:
  explicit PlyWriter(const SurfacePlan& plan)
      : SequenceWriter(plan),
        written_(*plan.mesh),
        mesh_(*plan.mesh),
        uvs_(vertex_uvs(mesh_)),
        normals_(vertex_normals(mesh_)),
        has_corner_uvs_(uvs_.empty() && has_uvs(mesh_)),
        has_long_counts_(needs_long_counts(mesh_, has_corner_uvs_ ? 2 : 1)) {
    const std::string_view count = has_long_counts_ ? "uint" : "uchar";
    header_ = fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment pliant\nelement vertex {}\n"
        "property double x\nproperty double y\nproperty double z\n{}{}"
        "element face {}\nproperty list {} int vertex_indices\n{}end_header\n",
        mesh_.vertex_count(),
        normals_.empty() ? "" : "property float nx\nproperty float ny\nproperty float nz\n",
        uvs_.empty() ? "" : "property double s\nproperty double t\n", mesh_.face_sizes.size(),
        count, has_corner_uvs_ ? fmt::format("property list {} float texcoord\n", count) : "");
    make_vertices();
  }

 private:
  Result<void> write_frame(const SurfacePose& pose, const ByteSink& sink) override {
    const Field& positions = pose.positions;
    const Mesh& mesh = written_.in_space(pose.is_mirrored);
    std::string& faces = faces_[pose.is_mirrored ? 1 : 0];
    StopPoll poll(should_stop());
    if (faces.empty()) faces = faces_of(mesh, poll);
    Result<Field> normals;
    if (!normals_.empty()) normals = unit_normals(mesh, positions, should_stop());
    if (!normals) return fail(normals.error());
    char* vertex = vertices_.data();
    for (Eigen::Index row = 0; row < positions.rows(); ++row, vertex += vertex_size()) {
      if (poll.after(4)) break;
      const double position[] = {positions(row, 0), positions(row, 1), positions(row, 2)};
      std::memcpy(vertex, position, sizeof(position));
      if (normals_.empty()) continue;
      const int of_vertex = normals_[static_cast<std::size_t>(row)];
      float normal[3];
      for (int k = 0; k < 3; ++k) normal[k] = static_cast<float>((*normals)(of_vertex, k));
      std::memcpy(vertex + sizeof(position), normal, sizeof(normal));
    }
    if (poll.after(0)) {
      faces.clear();
      return interrupted();
    }
    if (auto written = sink(header_); !written) return written;
    if (auto written = write_in_pieces(vertices_, should_stop(), sink); !written) return written;
    return write_in_pieces(faces, should_stop(), sink);
  }

  std::size_t vertex_size() const {
    return 3 * sizeof(double) + (normals_.empty() ? 0 : 3 * sizeof(float)) +
           (uvs_.empty() ? 0 : 2 * sizeof(double));
  }

  // Allocates positions and normals, and fills in the (u,v) after them.
  void make_vertices() {
    vertices_.resize(vertex_size() * static_cast<std::size_t>(mesh_.vertex_count()));
    char* end = vertices_.data();
    for (const Uv& uv : uvs_) {
      end += vertex_size();
      std::memcpy(end - sizeof(uv), uv.data(), sizeof(uv));
    }
  }

  // Unfinished if it is stopped.
  std::string faces_of(const Mesh& mesh, StopPoll& poll) const {
    std::string faces;
    const auto append_count = [&](int count) {
      if (has_long_counts_) {
        append_number(faces, static_cast<std::uint32_t>(count));
      } else {
        append_number(faces, static_cast<std::uint8_t>(count));
      }
    };
    std::size_t first = 0;
    for (const int size : mesh.face_sizes) {
      const std::size_t end = first + static_cast<std::size_t>(size);
      if (poll.after(16 * static_cast<std::size_t>(size))) break;
      append_count(size);
      for (std::size_t k = first; k < end; ++k)
        append_number(faces, static_cast<std::int32_t>(mesh.corner_vertices[k]));
      if (has_corner_uvs_) append_count(2 * size);
      for (std::size_t k = first; k < end && has_corner_uvs_; ++k) {
        const int uv = mesh.corner_uvs[k];
        for (int n = 0; n < 2; ++n) {
          append_number(
              faces, uv < 0 ? 0.0f : static_cast<float>(mesh.uvs[static_cast<std::size_t>(uv)][n]));
        }
      }
      first = end;
    }
    return faces;
  }

  WrittenMesh written_;
  const Mesh& mesh_;
  std::vector<Uv> uvs_;       // of the vertices, if each has one
  std::vector<int> normals_;  // likewise
  bool has_corner_uvs_;
  bool has_long_counts_;
  // Everything but positions and normals is the same in every frame of a space.
  std::string header_;
  std::array<std::string, 2> faces_;  // those of a mirrored space second
  std::string vertices_;
};

}  // namespace

Result<std::unique_ptr<SurfaceWriter>> make_ply_writer(const SurfacePlan& plan) {
  if (auto checked = check_sequence(plan); !checked) return fail(checked.error());
  return std::make_unique<PlyWriter>(plan);
}

}  // namespace pliant
