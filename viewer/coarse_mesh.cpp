#include "viewer/coarse_mesh.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <numeric>

namespace pliant::viewer {
namespace {

// Space divided into cubes, `count` of them along the longest side.
class Cubes {
 public:
  Cubes(const Field& positions, int count) : low_(positions.colwise().minCoeff().transpose()) {
    // Halves first: the difference of two large numbers may be too large.
    const Vector3d high = positions.colwise().maxCoeff();
    const double half = (0.5 * high - 0.5 * low_).maxCoeff();
    scale_ = half > 0 ? 0.5 * count / half : 0;
    last_ = count - 1;
  }

  // A number for the cube of each vertex.
  std::vector<std::uint64_t> of(const Field& positions) const {
    std::vector<std::uint64_t> cubes(static_cast<std::size_t>(positions.rows()), 0);
    for (std::size_t k = 0; k < cubes.size(); ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        const double half = 0.5 * positions(static_cast<Eigen::Index>(k), axis) - 0.5 * low_[axis];
        const double place = std::clamp(2 * (half * scale_), 0.0, static_cast<double>(last_));
        cubes[k] = (cubes[k] << 21U) | static_cast<std::uint64_t>(place);
      }
    }
    return cubes;
  }

 private:
  Vector3d low_;
  double scale_ = 0;
  int last_ = 0;
};

std::vector<std::uint64_t> distinct(std::vector<std::uint64_t> numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return numbers;
}

// The cubes of the vertices by their rank, as small as `most` allows.
std::vector<std::uint32_t> ranked_cubes(const Field& positions, int most) {
  int fits = 1, too_many = 1 << 20;
  while (too_many - fits > 1) {
    // There are at least as many cubes as along the longest side of a surface that is connected:
    // so begin small.
    const int count = fits < too_many / 4 ? 2 * fits : (fits + too_many) / 2;
    const auto cubes = distinct(Cubes(positions, count).of(positions));
    (cubes.size() <= static_cast<std::size_t>(most) ? fits : too_many) = count;
  }
  const auto cubes = Cubes(positions, fits).of(positions);
  const auto sorted = distinct(cubes);
  std::vector<std::uint32_t> ranks(cubes.size());
  std::transform(cubes.begin(), cubes.end(), ranks.begin(), [&](std::uint64_t cube) {
    return static_cast<std::uint32_t>(std::lower_bound(sorted.begin(), sorted.end(), cube) -
                                      sorted.begin());
  });
  return ranks;
}

// The vertex of each cube that is nearest to the middle of its vertices, the first of several.
std::vector<int> representatives(const Field& positions, std::span<const std::uint32_t> cubes) {
  const std::size_t count = std::size_t{1} + *std::max_element(cubes.begin(), cubes.end());
  std::vector<Vector3d> middles(count, Vector3d::Zero());
  std::vector<double> sizes(count, 0);
  for (const std::uint32_t cube : cubes) sizes[cube] += 1;
  const auto place = [&](std::size_t vertex) -> Vector3d {
    return positions.row(static_cast<Eigen::Index>(vertex)).transpose();
  };
  for (std::size_t k = 0; k < cubes.size(); ++k) middles[cubes[k]] += place(k) / sizes[cubes[k]];
  std::vector<int> nearest(count, -1);
  std::vector<double> distances(count, std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < cubes.size(); ++k) {
    const double distance = (place(k) - middles[cubes[k]]).norm();
    if (nearest[cubes[k]] >= 0 && !(distance < distances[cubes[k]])) continue;
    nearest[cubes[k]] = static_cast<int>(k);
    distances[cubes[k]] = distance;
  }
  return nearest;
}

}  // namespace

CoarseMesh coarse_mesh(const Field& positions, std::span<const std::uint32_t> triangles,
                       int most_vertices) {
  CoarseMesh coarse;
  if (positions.rows() <= most_vertices) {
    coarse.vertices.resize(static_cast<std::size_t>(positions.rows()));
    std::iota(coarse.vertices.begin(), coarse.vertices.end(), 0);
    coarse.triangles.assign(triangles.begin(), triangles.end());
    return coarse;
  }
  const std::vector<std::uint32_t> cubes = ranked_cubes(positions, most_vertices);
  const std::vector<int> vertex_of = representatives(positions, cubes);
  coarse.vertices = vertex_of;
  std::sort(coarse.vertices.begin(), coarse.vertices.end());
  std::vector<std::uint32_t> number_of(vertex_of.size());
  for (std::size_t cube = 0; cube < vertex_of.size(); ++cube) {
    number_of[cube] = static_cast<std::uint32_t>(
        std::lower_bound(coarse.vertices.begin(), coarse.vertices.end(), vertex_of[cube]) -
        coarse.vertices.begin());
  }
  std::vector<std::array<std::uint32_t, 3>> kept;
  for (std::size_t k = 0; k + 2 < triangles.size(); k += 3) {
    std::array<std::uint32_t, 3> corners = {number_of[cubes[triangles[k]]],
                                            number_of[cubes[triangles[k + 1]]],
                                            number_of[cubes[triangles[k + 2]]]};
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    kept.push_back(corners);
  }
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  for (const auto& corners : kept)
    coarse.triangles.insert(coarse.triangles.end(), corners.begin(), corners.end());
  return coarse;
}

}  // namespace pliant::viewer
