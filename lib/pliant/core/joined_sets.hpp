#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace pliant {

/// Disjoint sets of the points 0 to count - 1, at the beginning of one point each. Requires: the
/// points that are asked for are below `count`.
class JoinedSets {
 public:
  explicit JoinedSets(std::size_t count) : parents_(count) {
    std::iota(parents_.begin(), parents_.end(), 0);
  }

  /// The lowest point of a point's set.
  int first_of(int point) {
    while (parent(point) != point) point = parent(point) = parent(parent(point));
    return point;
  }

  /// Makes the sets of two points one.
  void join(int a, int b) {
    a = first_of(a), b = first_of(b);
    parent(std::max(a, b)) = std::min(a, b);
  }

 private:
  int& parent(int point) { return parents_[static_cast<std::size_t>(point)]; }

  std::vector<int> parents_;
};

}  // namespace pliant
