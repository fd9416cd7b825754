#include "pliant/mesh/triangles/point_tree.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "pliant/core/stoppable_sort.hpp"

namespace pliant {

Result<PointTree> PointTree::make(const Field& points, const StopRequest& should_stop,
                                  int most_of_leaf) {
  PointTree tree;
  if (points.rows() == 0) return tree;
  StopPoll poll(should_stop);
  std::vector<int>& rows = tree.rows_;
  std::vector<Cluster>& clusters = tree.clusters_;
  rows.resize(static_cast<std::size_t>(points.rows()));
  std::iota(rows.begin(), rows.end(), 0);
  clusters.push_back({.first = 0, .count = static_cast<int>(rows.size())});
  for (std::size_t k = 0; k < clusters.size(); ++k) {
    Cluster cluster = clusters[k];
    const auto begin = rows.begin() + cluster.first, end = begin + cluster.count;
    cluster.low = cluster.high = points.row(*begin).transpose();
    for (auto row = begin; row != end; ++row) {
      if (poll.after(4)) return interrupted();
      for (int axis = 0; axis < 3; ++axis) {
        cluster.low[axis] = std::min(cluster.low[axis], points(*row, axis));
        cluster.high[axis] = std::max(cluster.high[axis], points(*row, axis));
      }
    }
    if (cluster.count > most_of_leaf) {
      int widest = 0;
      const Vector3d extent = cluster.high - cluster.low;
      for (int axis = 1; axis < 3; ++axis) widest = extent[axis] > extent[widest] ? axis : widest;
      const int half = cluster.count / 2;
      const auto place = [&](int row) { return std::pair(points(row, widest), row); };
      if (!select_unless_stopped(begin, begin + half, end, poll,
                                 [&](int a, int b) { return place(a) < place(b); })) {
        return interrupted();
      }
      cluster.child = static_cast<int>(clusters.size());
      clusters.push_back({.first = cluster.first, .count = half});
      clusters.push_back({.first = cluster.first + half, .count = cluster.count - half});
    }
    clusters[k] = cluster;
  }
  tree.points_.resize(points.rows(), 3);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (poll.after(4)) return interrupted();
    tree.points_.row(static_cast<Eigen::Index>(k)) = points.row(rows[k]);
  }
  return tree;
}

}  // namespace pliant
