#pragma once

#include <array>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/core/transform.hpp"
#include "pliant/mesh/triangles/face_triangles.hpp"
#include "pliant/mesh/triangles/triangle_surface.hpp"

namespace pliant {

/// Points bound to the triangles of a surface, their driver, that follow its displacement and its
/// bending: docs/model.md, "Proxies".
///
/// A point p is bound to the closest point q of the driver's triangles at rest, with weights l_k of
/// the triangle's corners x_k. Its displacement is D(p) = sum of l_k (w_k + 1/2 G_k (q - x_k)): w_k
/// the corner's displacement, G_k the mean of its gradient over the triangles around the corner,
/// weighted by area. So it follows displacements up to second degree.
class Binding {
 public:
  /// `transform` takes the driver's object space to the space of `points` (#points x 3). Cost:
  /// O(#points log #triangles). Requires: all coordinates are finite. Errors: points that are as
  /// far from thousands of triangles; Interrupted.
  static Result<Binding> make(const TriangleSurface& driver, const Transform& transform,
                              const Field& points, const StopRequest& should_stop = {});

  int point_count() const { return static_cast<int>(triangles_of_points_.size()); }

  /// D at the points for the displacement of the driver's nodes, both #rows x 3 in the driver's
  /// object space [length]. Exactly 0 where the nodes around are still.
  Field displacements(const Field& nodes) const { return *displacements(nodes, {}, {}); }

  /// The same in the memory of `reuse`. Errors: Interrupted.
  Result<Field> displacements(const Field& nodes, Field reuse,
                              const StopRequest& should_stop) const;

 private:
  Binding() = default;
  void take_gradients(StopPoll& poll);

  FaceTriangles faces_;  // of the driver
  Field rest_;           // their points, the driver's object space

  // Area times the gradient of w in a triangle a, b, c is (w_b - w_a) times the first of its two
  // rows, and (w_c - w_a) times the second.
  Field gradients_;        // 2 #triangles x 3 [length]
  Eigen::VectorXd areas_;  // #nodes: of the triangles around [length^2]

  std::vector<int> triangles_of_points_;
  std::vector<std::array<double, 3>> weights_;  // one for each point
};

}  // namespace pliant
