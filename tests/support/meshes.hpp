#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "pliant/core/transform.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant::testing {

/// A mesh without (u,v).
inline Mesh mesh_of(const std::vector<Vector3d>& positions,
                    const std::vector<std::vector<int>>& faces) {
  Mesh mesh;
  mesh.positions.resize(static_cast<Eigen::Index>(positions.size()), 3);
  for (std::size_t k = 0; k < positions.size(); ++k) {
    mesh.positions.row(static_cast<Eigen::Index>(k)) = positions[k].transpose();
  }
  for (const std::vector<int>& face : faces) {
    mesh.face_sizes.push_back(static_cast<int>(face.size()));
    mesh.corner_vertices.insert(mesh.corner_vertices.end(), face.begin(), face.end());
  }
  mesh.corner_uvs.assign(mesh.corner_vertices.size(), -1);
  return mesh;
}

/// A flat square in the xz-plane, normals up, around the origin, of count x count cells. Each is a
/// quad, or two triangles with a diagonal by chance; vertices within are moved by up to `jitter`
/// spacings.
inline Mesh square(int count, double side, double jitter, bool has_quads = false,
                   unsigned seed = 1) {
  std::mt19937 random(seed);
  const auto chance = [&] { return static_cast<double>(random()) / 4294967296.0; };
  std::vector<Vector3d> positions;
  const double spacing = side / count;
  for (int j = 0; j <= count; ++j) {
    for (int i = 0; i <= count; ++i) {
      const bool is_within = i > 0 && i < count && j > 0 && j < count;
      const double x = (2 * chance() - 1) * jitter, z = (2 * chance() - 1) * jitter;
      positions.push_back({-side / 2 + spacing * (i + (is_within ? x : 0)), 0,
                           -side / 2 + spacing * (j + (is_within ? z : 0))});
    }
  }
  std::vector<std::vector<int>> faces;
  for (int j = 0; j < count; ++j) {
    for (int i = 0; i < count; ++i) {
      const int a = j * (count + 1) + i, b = a + 1, c = a + count + 1, d = c + 1;
      if (has_quads) {
        faces.push_back({a, c, d, b});
      } else if (chance() < 0.5) {
        faces.insert(faces.end(), {{a, c, d}, {a, d, b}});
      } else {
        faces.insert(faces.end(), {{a, c, b}, {b, c, d}});
      }
    }
  }
  return mesh_of(positions, faces);
}

/// The unit sphere: an icosahedron whose triangles are divided `levels` times.
inline Mesh sphere(int levels) {
  const double t = (1 + std::sqrt(5.0)) / 2;
  std::vector<Vector3d> positions = {{-1, t, 0}, {1, t, 0}, {-1, -t, 0}, {1, -t, 0},
                                     {0, -1, t}, {0, 1, t}, {0, -1, -t}, {0, 1, -t},
                                     {t, 0, -1}, {t, 0, 1}, {-t, 0, -1}, {-t, 0, 1}};
  std::vector<std::vector<int>> faces = {
      {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [place, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<int>(positions.size()));
      if (is_new) positions.push_back(0.5 * (positions[a] + positions[b]));
      return place->second;
    };
    std::vector<std::vector<int>> finer;
    for (const auto& face : faces) {
      const int ab = middle(face[0], face[1]), bc = middle(face[1], face[2]),
                ca = middle(face[2], face[0]);
      finer.insert(finer.end(),
                   {{face[0], ab, ca}, {face[1], bc, ab}, {face[2], ca, bc}, {ab, bc, ca}});
    }
    faces = std::move(finer);
  }
  for (Vector3d& position : positions) position.normalize();
  return mesh_of(positions, faces);
}

}  // namespace pliant::testing
