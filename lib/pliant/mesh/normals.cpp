#include "pliant/mesh/normals.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "pliant/core/expects.hpp"
#include "pliant/mesh/triangles/equal_numbers.hpp"

namespace pliant {
namespace {

// Twice the area of a face times its normal; exact if the face is flat, otherwise a mean.
Vector3d area_vector(const Mesh& mesh, const Field& positions, std::size_t first, int size) {
  const auto at = [&](int k) -> Vector3d {
    return positions.row(mesh.corner_vertices[first + static_cast<std::size_t>(k)]);
  };
  const Vector3d origin = at(0);
  Vector3d sum = Vector3d::Zero();
  Vector3d previous = at(1) - origin;
  for (int k = 2; k < size; ++k) {
    const Vector3d next = at(k) - origin;
    sum += previous.cross(next);
    previous = next;
  }
  return sum;
}

using Row = std::array<double, 3>;

}  // namespace

int normal_count(const Mesh& mesh) {
  if (mesh.corner_normals.empty()) return mesh.vertex_count();
  return *std::max_element(mesh.corner_normals.begin(), mesh.corner_normals.end()) + 1;
}

bool is_flat(const Mesh& mesh) {
  if (mesh.corner_normals.empty()) return false;
  std::vector<int> face_of(static_cast<std::size_t>(normal_count(mesh)), -1);
  std::size_t corner = 0;
  for (std::size_t face = 0; face < mesh.face_sizes.size(); ++face) {
    for (int k = 0; k < mesh.face_sizes[face]; ++k, ++corner) {
      int& known = face_of[static_cast<std::size_t>(mesh.corner_normals[corner])];
      if (known >= 0 && known != static_cast<int>(face)) return false;
      known = static_cast<int>(face);
    }
  }
  return true;
}

Field unit_normals(const Mesh& mesh, const Field& positions) {
  return *unit_normals(mesh, positions, {});
}

Result<Field> unit_normals(const Mesh& mesh, const Field& positions,
                           const StopRequest& should_stop) {
  PLIANT_EXPECTS(positions.rows() == mesh.positions.rows());
  StopPoll poll(should_stop);
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> sums;
  sums.setZero(normal_count(mesh), 3);
  std::size_t corner = 0;
  for (const int size : mesh.face_sizes) {
    if (poll.after(8 * static_cast<std::size_t>(size))) return interrupted();
    const Vector3d area = area_vector(mesh, positions, corner, size);
    for (int k = 0; k < size; ++k, ++corner) sums.row(normal_of(mesh, corner)) += area;
  }
  for (Eigen::Index k = 0; k < sums.rows(); ++k) {
    if (poll.after(16)) return interrupted();
    // Divided by its largest component first, so that the squares neither underflow nor overflow.
    const double largest = sums.row(k).cwiseAbs().maxCoeff();
    if (largest > 0 && std::isfinite(largest)) {
      sums.row(k) /= largest;
      sums.row(k) /= std::sqrt(sums.row(k).squaredNorm());
    } else {
      sums.row(k) << 0, 1, 0;
    }
  }
  return Field(sums);
}

Result<std::vector<int>> shared_normals(const Mesh& mesh, const Shading& shading,
                                        const StopRequest& should_stop) {
  const bool has_normals = std::any_of(shading.corner_normals.begin(), shading.corner_normals.end(),
                                       [](int normal) { return normal >= 0; });
  const bool has_smoothing = std::any_of(shading.smoothing.begin(), shading.smoothing.end(),
                                         [](int group) { return group != Shading::unsaid; });
  if (!has_normals && !has_smoothing) return {};
  StopPoll poll(should_stop);
  std::vector<int> places, directions;
  if (has_normals) {
    std::vector<Row> rows(static_cast<std::size_t>(mesh.vertex_count()));
    for (int k = 0; k < mesh.vertex_count(); ++k)
      rows[static_cast<std::size_t>(k)] = {mesh.positions(k, 0), mesh.positions(k, 1),
                                           mesh.positions(k, 2)};
    places = numbers_of_equal(rows, poll);
    directions = numbers_of_equal(shading.normals, poll);
  }
  std::vector<std::array<int, 3>> keys;  // the last number distinguishes their kinds
  keys.reserve(mesh.corner_vertices.size());
  bool is_any_flat = false;
  for (std::size_t face = 0; face < mesh.face_sizes.size(); ++face) {
    const int smoothing = shading.smoothing.empty() ? Shading::unsaid : shading.smoothing[face];
    is_any_flat = is_any_flat || smoothing == Shading::flat;
    for (int k = 0; k < mesh.face_sizes[face]; ++k) {
      const int vertex = mesh.corner_vertices[keys.size()];
      const int normal = has_normals ? shading.corner_normals[keys.size()] : -1;
      if (smoothing == Shading::flat) {
        keys.push_back({static_cast<int>(face), 0, -2});
      } else if (normal >= 0) {
        keys.push_back({places[static_cast<std::size_t>(vertex)],
                        directions[static_cast<std::size_t>(normal)], -3});
      } else {
        keys.push_back({vertex, 0, smoothing});
      }
    }
    if (poll.after(static_cast<std::size_t>(mesh.face_sizes[face]))) return interrupted();
  }
  std::vector<int> shared = numbers_of_equal(keys, poll);
  if (poll.after(shared.size())) return interrupted();
  bool is_by_vertex = !has_normals && !is_any_flat;
  std::vector<int> of_vertex(static_cast<std::size_t>(mesh.vertex_count()), -1);
  for (std::size_t corner = 0; is_by_vertex && corner < shared.size(); ++corner) {
    int& known = of_vertex[static_cast<std::size_t>(mesh.corner_vertices[corner])];
    is_by_vertex = known < 0 || known == shared[corner];
    known = shared[corner];
  }
  if (is_by_vertex) return {};
  return shared;
}

}  // namespace pliant
