#include "pliant/mesh/normals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <unordered_map>

#include <Eigen/Geometry>

#include "pliant/core/expects.hpp"

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

// Numbers that are equal exactly for equal rows.
std::vector<int> numbers_of_equal(const std::vector<Row>& rows) {
  std::vector<int> order(rows.size());
  std::iota(order.begin(), order.end(), 0);
  const auto row = [&](int k) -> const Row& { return rows[static_cast<std::size_t>(k)]; };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return row(a) < row(b); });
  std::vector<int> numbers(rows.size());
  int number = -1;
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k == 0 || row(order[k]) != row(order[k - 1])) ++number;
    numbers[static_cast<std::size_t>(order[k])] = number;
  }
  return numbers;
}

// Numbers keys in the order of their first use.
class Numbering {
 public:
  using Key = std::array<int, 3>;

  int number_of(const Key& key) {
    return numbers_.try_emplace(key, static_cast<int>(numbers_.size())).first->second;
  }

 private:
  struct Hash {
    std::size_t operator()(const Key& key) const {
      std::uint64_t hash = 0;
      for (const int part : key) {
        hash = (hash ^ static_cast<std::uint32_t>(part)) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 29;
      }
      return static_cast<std::size_t>(hash);
    }
  };
  std::unordered_map<Key, int, Hash> numbers_;
};

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
  PLIANT_EXPECTS(positions.rows() == mesh.positions.rows());
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> sums;
  sums.setZero(normal_count(mesh), 3);
  std::size_t corner = 0;
  for (const int size : mesh.face_sizes) {
    const Vector3d area = area_vector(mesh, positions, corner, size);
    for (int k = 0; k < size; ++k, ++corner) sums.row(normal_of(mesh, corner)) += area;
  }
  for (Eigen::Index k = 0; k < sums.rows(); ++k) {
    // Divided by its largest component first, so that the squares neither underflow nor overflow.
    const double largest = sums.row(k).cwiseAbs().maxCoeff();
    if (largest > 0 && std::isfinite(largest)) {
      sums.row(k) /= largest;
      sums.row(k) /= std::sqrt(sums.row(k).squaredNorm());
    } else {
      sums.row(k) << 0, 1, 0;
    }
  }
  return sums;
}

std::vector<int> shared_normals(const Mesh& mesh, const Shading& shading) {
  const bool has_normals = std::any_of(shading.corner_normals.begin(), shading.corner_normals.end(),
                                       [](int normal) { return normal >= 0; });
  const bool has_smoothing = std::any_of(shading.smoothing.begin(), shading.smoothing.end(),
                                         [](int group) { return group != Shading::unsaid; });
  if (!has_normals && !has_smoothing) return {};
  std::vector<int> places, directions;
  if (has_normals) {
    std::vector<Row> rows(static_cast<std::size_t>(mesh.vertex_count()));
    for (int k = 0; k < mesh.vertex_count(); ++k)
      rows[static_cast<std::size_t>(k)] = {mesh.positions(k, 0), mesh.positions(k, 1),
                                           mesh.positions(k, 2)};
    places = numbers_of_equal(rows);
    directions = numbers_of_equal(shading.normals);
  }
  Numbering numbering;
  std::vector<int> shared(mesh.corner_vertices.size());
  bool is_by_vertex = !has_normals;
  std::vector<int> of_vertex(static_cast<std::size_t>(mesh.vertex_count()), -1);
  std::size_t corner = 0;
  for (std::size_t face = 0; face < mesh.face_sizes.size(); ++face) {
    const int smoothing = shading.smoothing.empty() ? Shading::unsaid : shading.smoothing[face];
    for (int k = 0; k < mesh.face_sizes[face]; ++k, ++corner) {
      const auto vertex = static_cast<std::size_t>(mesh.corner_vertices[corner]);
      const int normal = has_normals ? shading.corner_normals[corner] : -1;
      // The last number distinguishes the kinds of keys.
      if (smoothing == Shading::flat) {
        shared[corner] = numbering.number_of({static_cast<int>(face), 0, -2});
      } else if (normal >= 0) {
        shared[corner] =
            numbering.number_of({places[vertex], directions[static_cast<std::size_t>(normal)], -3});
      } else {
        shared[corner] = numbering.number_of({mesh.corner_vertices[corner], 0, smoothing});
      }
      is_by_vertex = is_by_vertex && smoothing != Shading::flat &&
                     (of_vertex[vertex] < 0 || of_vertex[vertex] == shared[corner]);
      of_vertex[vertex] = shared[corner];
    }
  }
  if (is_by_vertex) return {};
  return shared;
}

}  // namespace pliant
