#include "pliant/mesh/point_tree.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace pliant {

PointTree::PointTree(const Field& points) : rows_(static_cast<std::size_t>(points.rows())) {
  std::iota(rows_.begin(), rows_.end(), 0);
  if (rows_.empty()) return;
  parts_.push_back({.first = 0, .count = static_cast<int>(rows_.size())});
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    Part part = parts_[k];
    const auto begin = rows_.begin() + part.first, end = begin + part.count;
    part.low = part.high = points.row(*begin).transpose();
    for (auto row = begin; row != end; ++row) {
      for (int axis = 0; axis < 3; ++axis) {
        part.low[axis] = std::min(part.low[axis], points(*row, axis));
        part.high[axis] = std::max(part.high[axis], points(*row, axis));
      }
    }
    if (part.count > leaf_size) {
      int widest = 0;
      const Vector3d extent = part.high - part.low;
      for (int axis = 1; axis < 3; ++axis) widest = extent[axis] > extent[widest] ? axis : widest;
      const int half = part.count / 2;
      const auto place = [&](int row) { return std::pair(points(row, widest), row); };
      std::nth_element(begin, begin + half, end, [&](int a, int b) { return place(a) < place(b); });
      part.child = static_cast<int>(parts_.size());
      parts_.push_back({.first = part.first, .count = half});
      parts_.push_back({.first = part.first + half, .count = part.count - half});
    }
    parts_[k] = part;
  }
  points_.resize(points.rows(), 3);
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    points_.row(static_cast<Eigen::Index>(k)) = points.row(rows_[k]);
  }
}

}  // namespace pliant
