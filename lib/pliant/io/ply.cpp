#include "pliant/io/ply.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "pliant/io/atomic_file.hpp"
#include "pliant/io/sequence.hpp"

namespace pliant {
namespace {

using Uv = std::array<double, 2>;

// The (u,v) of each vertex; nothing when a vertex has none, or several that differ.
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

// An unsigned integer of so many bytes, little endian.
void append(std::string& bytes, std::uint32_t number, int size) {
  for (int k = 0; k < size; ++k) bytes += static_cast<char>(number >> 8 * k & 0xff);
}

bool needs_long_counts(const Mesh& mesh) {
  return std::any_of(mesh.face_sizes.begin(), mesh.face_sizes.end(),
                     [](int size) { return size > 255; });
}

std::string ply_header(const Mesh& mesh, bool has_uvs) {
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment pliant\nelement vertex {}\n"
      "property double x\nproperty double y\nproperty double z\n{}"
      "element face {}\nproperty list {} int vertex_indices\nend_header\n",
      mesh.vertex_count(), has_uvs ? "property double s\nproperty double t\n" : "",
      mesh.face_sizes.size(), needs_long_counts(mesh) ? "uint" : "uchar");
}

std::string ply_faces(const Mesh& mesh) {
  const int count_size = needs_long_counts(mesh) ? 4 : 1;
  std::string bytes;
  bytes.reserve(mesh.face_sizes.size() * static_cast<std::size_t>(count_size) +
                mesh.corner_vertices.size() * 4);
  std::size_t corner = 0;
  for (const int size : mesh.face_sizes) {
    append(bytes, static_cast<std::uint32_t>(size), count_size);
    for (int k = 0; k < size; ++k, ++corner)
      append(bytes, static_cast<std::uint32_t>(mesh.corner_vertices[corner]), 4);
  }
  return bytes;
}

class PlyWriter final : public AnimationWriter {
 public:
  explicit PlyWriter(const AnimationPlan& plan)
      : pattern_(plan.file), faces_(ply_faces(*plan.mesh)) {
    const std::vector<Uv> uvs = vertex_uvs(*plan.mesh);
    header_ = ply_header(*plan.mesh, !uvs.empty());
    vertices_.resize(plan.mesh->vertex_count(), uvs.empty() ? 3 : 5);
    for (std::size_t k = 0; k < uvs.size(); ++k)
      vertices_.row(static_cast<Eigen::Index>(k)).tail<2>() << uvs[k][0], uvs[k][1];
  }

  Result<void> write(int frame, const Field& positions) override {
    auto file = AtomicFile::create(sequence_file(pattern_, frame));
    if (!file) return fail(file.error());
    vertices_.leftCols<3>() = positions;
    if (auto written = file->write(header_); !written) return written;
    const std::span numbers(vertices_.data(), static_cast<std::size_t>(vertices_.size()));
    if (auto written = file->write(numbers); !written) return written;
    if (auto written = file->write(faces_); !written) return written;
    return file->commit();
  }

  Result<void> finish() override { return {}; }

 private:
  // Everything but the positions is the same in every frame.
  std::filesystem::path pattern_;
  std::string header_;
  // x y z of each vertex, and s t if it has them: the file's order, kept
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> vertices_;
  std::string faces_;
};

}  // namespace

Result<std::unique_ptr<AnimationWriter>> make_ply_writer(const AnimationPlan& plan) {
  if (auto checked = check_sequence(plan); !checked) return fail(checked.error());
  return std::make_unique<PlyWriter>(plan);
}

}  // namespace pliant
