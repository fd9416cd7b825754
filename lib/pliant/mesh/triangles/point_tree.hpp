#pragma once

#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant {

/// Points in a balanced binary tree of boxes, so that a search visits few of them. The tree depends
/// on the points and their order only.
class PointTree {
 public:
  /// The most points of a leaf, if not told otherwise.
  static constexpr int leaf_size = 32;

  /// The points [first, first + count) of `points`, in their smallest box.
  struct Cluster {
    Vector3d low = {0, 0, 0};   ///< the least of their x, y and z [length]
    Vector3d high = {0, 0, 0};  ///< the largest
    int first = 0;
    int count = 0;
    int child = -1;  ///< index of the first of its two halves, which are neighbours; -1: a leaf

    bool is_leaf() const { return child < 0; }
  };

  PointTree() = default;

  /// Requires: `points` is #points x 3, finite. Errors: Interrupted. Cost: O(#points log #points).
  static Result<PointTree> make(const Field& points, const StopRequest& should_stop,
                                int most_of_leaf = leaf_size);

  explicit PointTree(const Field& points) : PointTree(*make(points, {})) {}

  /// The whole first; empty without points.
  const std::vector<Cluster>& clusters() const { return clusters_; }

  /// The points in the order of the leaves, #points x 3 [length].
  const Field& points() const { return points_; }

  /// The row in the constructor's field of each of `points()`.
  const std::vector<int>& rows() const { return rows_; }

 private:
  std::vector<Cluster> clusters_;
  Field points_;
  std::vector<int> rows_;
};

}  // namespace pliant
