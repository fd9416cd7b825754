#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/mesh/triangles/point_tree.hpp"

namespace pliant {

/// The point of some triangles that is closest to another one.
struct ClosestPoint {
  int triangle = 0;
  std::array<double, 3> weights = {1, 0, 0};  ///< of the triangle's corners: barycentric, sum 1
  std::size_t tried = 0;                      ///< triangles that the search looked at
};

/// Triangles in a tree of boxes, so that a search visits few of them. Degenerate triangles are
/// segments and points.
class TriangleTree {
 public:
  /// Requires: at least one triangle; its corners are rows of `points` (#points x 3), finite.
  /// Errors: Interrupted.
  static Result<TriangleTree> make(const Field& points, std::vector<std::array<int, 3>> triangles,
                                   const StopRequest& should_stop);

  TriangleTree(const Field& points, std::vector<std::array<int, 3>> triangles)
      : TriangleTree(*make(points, std::move(triangles), {})) {}

  /// Of equally close triangles the first one. The search is faster if the triangle `near` is near.
  ClosestPoint closest(const Vector3d& p, int near = 0) const;

  /// The first triangle that is farther than the closest one by at most `tolerance`, and its
  /// closest point.
  ClosestPoint first_of_closest(const Vector3d& p, double tolerance) const;

 private:
  struct Found;
  TriangleTree() = default;
  struct Box {
    Vector3d low, high;
  };

  void try_triangle(int triangle, const Vector3d& p, Found& found) const;
  double squared_distance(int cluster, const Vector3d& p) const;

  Field points_;
  std::vector<std::array<int, 3>> triangles_;
  PointTree centres_;       // of the triangles
  std::vector<Box> boxes_;  // one for each cluster of the tree, around its triangles
};

}  // namespace pliant
