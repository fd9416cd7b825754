#pragma once

#include <cmath>
#include <map>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "pliant/contact/solid.hpp"

namespace pliant::testing {

/// A mesh as a solid. Requires: it is closed.
inline MeshSolid solid_of(std::vector<SolidMesh::Corners> triangles, const Field& points) {
  auto mesh = SolidMesh::make(std::move(triangles), points).value();
  return {std::make_shared<const PosedMesh>(std::move(mesh), points)};
}

/// Joins triangles given by places, equal places to one point.
class TriangleSoup {
 public:
  void add(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    triangles_.push_back({point(a), point(b), point(c)});
  }
  void add_quad(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
    add(a, b, c);
    add(a, c, d);
  }
  Field points() const {
    Field field(static_cast<Eigen::Index>(points_.size()), 3);
    for (std::size_t k = 0; k < points_.size(); ++k)
      field.row(static_cast<Eigen::Index>(k)) = points_[k].transpose();
    return field;
  }
  const std::vector<SolidMesh::Corners>& triangles() const { return triangles_; }
  MeshSolid solid() const { return solid_of(triangles_, points()); }

 private:
  int point(const Vector3d& at) {
    const auto [found, is_new] = places_.try_emplace({at[0] + 0.0, at[1] + 0.0, at[2] + 0.0},
                                                     static_cast<int>(points_.size()));
    if (is_new) points_.push_back(at);
    return found->second;
  }

  std::map<std::tuple<double, double, double>, int> places_;
  std::vector<Vector3d> points_;
  std::vector<SolidMesh::Corners> triangles_;
};

/// Adds the sides of a box, each of count x count quads; `is_inward`: they look inwards.
inline void add_box(TriangleSoup& soup, const Vector3d& size, int count, bool is_inward = false) {
  const auto at = [&](const Eigen::Vector3i& index) {
    Vector3d place;
    for (int k = 0; k < 3; ++k) place[k] = size[k] * (double(index[k]) / count - 0.5);
    return place;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int next = (axis + 1) % 3, last = (axis + 2) % 3;
    for (const int side : {0, count}) {
      for (int i = 0; i < count; ++i) {
        for (int j = 0; j < count; ++j) {
          std::array<Vector3d, 4> corners;
          const int steps[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
          for (int c = 0; c < 4; ++c) {
            Eigen::Vector3i index;
            index[axis] = side;
            index[next] = i + steps[c][0];
            index[last] = j + steps[c][1];
            corners[c] = at(index);
          }
          if ((side == 0) != is_inward) std::swap(corners[1], corners[3]);
          soup.add_quad(corners[0], corners[1], corners[2], corners[3]);
        }
      }
    }
  }
}

inline MeshSolid box_mesh(const Vector3d& size, int count) {
  TriangleSoup soup;
  add_box(soup, size, count);
  return soup.solid();
}

/// A box with a room within it.
inline MeshSolid hollow_mesh() {
  TriangleSoup soup;
  add_box(soup, {2, 2.2, 2}, 2);
  add_box(soup, {1.2, 1, 1.4}, 1, true);
  return soup.solid();
}

/// A ball of triangles whose corners lie on it, as `sides` on a quarter of its equator.
inline MeshSolid ball_mesh(double radius, int sides) {
  TriangleSoup soup;
  // An octahedron, of which each side is divided.
  for (int octant = 0; octant < 8; ++octant) {
    const Vector3d signs(octant & 1 ? -1 : 1, octant & 2 ? -1 : 1, octant & 4 ? -1 : 1);
    const bool turns = signs[0] * signs[1] * signs[2] < 0;
    const auto at = [&](int i, int j) {
      const Vector3d flat(i, j, sides - i - j);
      return Vector3d(signs.cwiseProduct(radius / flat.norm() * flat));
    };
    const auto add = [&](const Vector3d& a, const Vector3d& b, const Vector3d& c) {
      turns ? soup.add(a, c, b) : soup.add(a, b, c);
    };
    for (int i = 0; i < sides; ++i) {
      for (int j = 0; i + j < sides; ++j) {
        add(at(i, j), at(i + 1, j), at(i, j + 1));
        if (i + j + 1 < sides) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
    }
  }
  return soup.solid();
}

/// A ball with spikes and hollows.
inline MeshSolid star_mesh() {
  const MeshSolid ball = ball_mesh(1, 6);
  Field points = ball.posed->points();
  for (Eigen::Index k = 0; k < points.rows(); ++k) points.row(k) *= k % 3 == 0 ? 1.4 : 0.6;
  return solid_of(ball.posed->mesh().triangles(), points);
}

/// A box whose top has a corner in the middle of an edge, which the side knows by a triangle as low
/// as `height`, and a strip of quads as low along another edge.
inline MeshSolid box_with_needles(const Vector3d& size, double height) {
  const double x = size[0] / 2, y = size[1] / 2, z = size[2] / 2;
  TriangleSoup soup;
  const auto at = [&](double a, double b, double c) { return Vector3d(a * x, b * y, c * z); };
  const Vector3d middle(0.1 * x, y, z), top_low(-x, y - height, -z), other_low(x, y - height, -z);
  // Above, with a corner on its edge at +z.
  soup.add(at(-1, 1, 1), middle, at(1, 1, -1));
  soup.add(middle, at(1, 1, 1), at(1, 1, -1));
  soup.add(at(-1, 1, 1), at(1, 1, -1), at(-1, 1, -1));
  // The triangle without area between the edge and its halves.
  soup.add(at(-1, 1, 1), at(1, 1, 1), middle);
  soup.add_quad(at(-1, -1, 1), at(1, -1, 1), at(1, 1, 1), at(-1, 1, 1));
  if (height > 0) {
    // At -z, a low strip under the edge; the sides at its ends have a corner more.
    soup.add_quad(at(1, 1, -1), other_low, top_low, at(-1, 1, -1));
    soup.add_quad(other_low, at(1, -1, -1), at(-1, -1, -1), top_low);
    soup.add(at(1, -1, -1), other_low, at(1, 1, 1));
    soup.add(other_low, at(1, 1, -1), at(1, 1, 1));
    soup.add(at(1, -1, -1), at(1, 1, 1), at(1, -1, 1));
    soup.add(at(-1, -1, -1), at(-1, 1, 1), top_low);
    soup.add(top_low, at(-1, 1, 1), at(-1, 1, -1));
    soup.add(at(-1, -1, -1), at(-1, -1, 1), at(-1, 1, 1));
  } else {
    soup.add_quad(at(1, 1, -1), at(1, -1, -1), at(-1, -1, -1), at(-1, 1, -1));
    soup.add_quad(at(1, -1, -1), at(1, 1, -1), at(1, 1, 1), at(1, -1, 1));
    soup.add_quad(at(-1, -1, -1), at(-1, -1, 1), at(-1, 1, 1), at(-1, 1, -1));
  }
  soup.add_quad(at(-1, -1, -1), at(1, -1, -1), at(1, -1, 1), at(-1, -1, 1));
  return soup.solid();
}

}  // namespace pliant::testing
