#include "pliant/mesh/triangles/weld.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "pliant/core/joined_sets.hpp"
#include "pliant/mesh/triangles/point_tree.hpp"

namespace pliant {
namespace {

double squared(const Vector3d& a) { return a[0] * a[0] + a[1] * a[1] + a[2] * a[2]; }

// Joins the points of a tree by pairs of its clusters that are near to each other.
class Welding {
 public:
  Welding(const PointTree& tree, double distance, const StopRequest& should_stop)
      : tree_(tree),
        squared_distance_(distance * distance),
        distance_(distance),
        sets_(tree.rows().size()),
        steps_left_(most_steps_of_point * tree.rows().size() + least_steps),
        poll_(should_stop) {}

  Result<void> run() {
    if (!tree_.clusters().empty()) within(tree_.clusters()[0]);
    if (poll_.after(0)) return interrupted();
    if (steps_left_ > 0) return {};
    return invalid(
        fmt::format("too many of its {} vertices are nearly, but not quite, within {} of each "
                    "other, and so one node; give the attribute weld another distance",
                    tree_.rows().size(), distance_));
  }

  int first_of(int row) { return sets_.first_of(row); }

 private:
  using Cluster = PointTree::Cluster;

  // Points can lie so that almost all pairs of them are almost near: this bounds the work. A grid
  // with that distance as its spacing takes some 100 steps a point.
  static constexpr std::size_t most_steps_of_point = 1000, least_steps = 100'000;

  const Cluster& half(const Cluster& cluster, int k) const {
    return tree_.clusters()[cluster.child + k];
  }
  int row(int point) const { return tree_.rows()[point]; }
  bool is_one(const Cluster& cluster) const { return are_near(cluster.high - cluster.low); }
  bool are_near(const Vector3d& apart) const {
    // The square of a tiny distance may underflow.
    return squared(apart) <= squared_distance_ && apart.cwiseAbs().maxCoeff() <= distance_;
  }
  bool are_near(int a, int b) const {
    return are_near((tree_.points().row(a) - tree_.points().row(b)).transpose());
  }
  bool is_near(int point, const Cluster& cluster) const {
    const Vector3d place = tree_.points().row(point).transpose();
    return are_near((cluster.low - place).cwiseMax(place - cluster.high).cwiseMax(0));
  }

  // Whether to go on after some more pairs of points or clusters.
  bool may_go_on(int steps) {
    constexpr std::size_t clusters_of_step = 8;
    const auto count = static_cast<std::size_t>(steps);
    steps_left_ -= std::min(count, steps_left_);
    return !poll_.after(clusters_of_step * count) && steps_left_ > 0;
  }

  void within(const Cluster& cluster) {
    if (!may_go_on(1)) return;
    const int end = cluster.first + cluster.count;
    if (is_one(cluster)) {
      for (int a = cluster.first + 1; a < end && may_go_on(1); ++a)
        sets_.join(row(cluster.first), row(a));
      return;
    }
    if (cluster.is_leaf()) {
      for (int a = cluster.first; a < end && may_go_on(end - a); ++a) {
        for (int b = a + 1; b < end; ++b) {
          if (are_near(a, b)) sets_.join(row(a), row(b));
        }
      }
      return;
    }
    within(half(cluster, 0));
    within(half(cluster, 1));
    between(half(cluster, 0), half(cluster, 1));
  }

  void between(const Cluster& a, const Cluster& b) {
    if (!may_go_on(1)) return;
    const Vector3d gap = (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0);
    if (!are_near(gap)) return;
    if (is_one(a) && is_one(b) && sets_.first_of(row(a.first)) == sets_.first_of(row(b.first))) {
      return;
    }
    if (a.is_leaf() && b.is_leaf()) {
      for (int i = a.first; i < a.first + a.count && may_go_on(1); ++i) {
        if (!is_near(i, b) || !may_go_on(b.count)) continue;
        for (int j = b.first; j < b.first + b.count; ++j) {
          if (are_near(i, j)) sets_.join(row(i), row(j));
        }
      }
      return;
    }
    const bool is_a_split = !a.is_leaf() && (b.is_leaf() || a.count >= b.count);
    const Cluster& split = is_a_split ? a : b;
    const Cluster& other = is_a_split ? b : a;
    between(half(split, 0), other);
    between(half(split, 1), other);
  }

  const PointTree& tree_;
  double squared_distance_, distance_;
  JoinedSets sets_;
  std::size_t steps_left_;
  StopPoll poll_;
};

}  // namespace

Result<std::vector<int>> welded(const Field& points, double distance,
                                const StopRequest& should_stop) {
  const PointTree tree(points);
  Welding welding(tree, distance, should_stop);
  if (auto run = welding.run(); !run) return fail(run.error());
  std::vector<int> first(static_cast<std::size_t>(points.rows()));
  for (std::size_t k = 0; k < first.size(); ++k) first[k] = welding.first_of(static_cast<int>(k));
  return first;
}

}  // namespace pliant
