#include "pliant/mesh/triangles/triangle_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

namespace pliant {
namespace {

using Triangle = std::array<Vector3d, 3>;

Field centres_of(const Field& points, const std::vector<std::array<int, 3>>& triangles) {
  Field centres(static_cast<Eigen::Index>(triangles.size()), 3);
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    const auto& [a, b, c] = triangles[k];
    centres.row(static_cast<Eigen::Index>(k)) =
        points.row(a) / 3 + points.row(b) / 3 + points.row(c) / 3;
  }
  return centres;
}

// The weights of the point inside a triangle that p lies above; some are below 0 if there is none.
std::array<double, 3> weights_above(const Triangle& corners, const Vector3d& p) {
  const Vector3d along_b = corners[1] - corners[0], along_c = corners[2] - corners[0];
  const Vector3d normal = along_b.cross(along_c);
  const double size = normal.squaredNorm();
  if (!(size > 0)) return {-1, -1, -1};
  const Vector3d way = p - corners[0];
  const double b = way.cross(along_c).dot(normal) / size;
  const double c = along_b.cross(way).dot(normal) / size;
  return {1 - b - c, b, c};
}

// The weights of the point on the side from corner k on.
std::array<double, 3> weights_on_side(const Triangle& corners, int k, const Vector3d& p) {
  const int next = (k + 1) % 3;
  const Vector3d side = corners[next] - corners[k];
  const double size = side.squaredNorm();
  double share = size > 0 ? (p - corners[k]).dot(side) / size : 0;
  share = share > 0 ? std::min(share, 1.0) : 0;
  std::array<double, 3> weights = {0, 0, 0};
  weights[k] = 1 - share;
  weights[next] = share;
  return weights;
}

}  // namespace

struct TriangleTree::Found {
  ClosestPoint place;
  double squared_distance = std::numeric_limits<double>::infinity();

  // Needles have weights above that are all rounding, so that each candidate is measured.
  void try_triangle(int triangle, const Triangle& corners, const Vector3d& p) {
    const auto try_weights = [&](const std::array<double, 3>& weights) {
      Vector3d way = -p;
      for (int k = 0; k < 3; ++k) way += weights[k] * corners[k];
      const double squared = way.squaredNorm();
      const bool is_closer =
          squared < squared_distance || (squared == squared_distance && triangle < place.triangle);
      if (!is_closer) return;
      place.triangle = triangle;
      place.weights = weights;
      squared_distance = squared;
    };
    ++place.tried;
    const std::array<double, 3> above = weights_above(corners, p);
    if (std::ranges::all_of(above, [](double weight) { return weight >= 0; })) try_weights(above);
    for (int k = 0; k < 3; ++k) try_weights(weights_on_side(corners, k, p));
  }
};

Result<TriangleTree> TriangleTree::make(const Field& points,
                                        std::vector<std::array<int, 3>> triangles,
                                        const StopRequest& should_stop) {
  auto centres = PointTree::make(centres_of(points, triangles), should_stop);
  if (!centres) return fail(centres.error());
  StopPoll poll(should_stop);
  TriangleTree tree;
  tree.points_ = points;
  tree.triangles_ = std::move(triangles);
  tree.centres_ = *std::move(centres);
  const std::vector<PointTree::Cluster>& clusters = tree.centres_.clusters();
  std::vector<Box>& boxes = tree.boxes_;
  boxes.resize(clusters.size());
  for (std::size_t k = clusters.size(); k-- > 0;) {  // children come after their parents
    if (poll.after(100)) return interrupted();
    Box box{Vector3d::Constant(std::numeric_limits<double>::infinity()), {}};
    box.high = -box.low;
    const auto include = [&](const Vector3d& low, const Vector3d& high) {
      box.low = box.low.cwiseMin(low);
      box.high = box.high.cwiseMax(high);
    };
    if (clusters[k].is_leaf()) {
      for (int n = clusters[k].first; n < clusters[k].first + clusters[k].count; ++n) {
        for (const int corner : tree.triangles_[tree.centres_.rows()[n]]) {
          const Vector3d point = points.row(corner).transpose();
          include(point, point);
        }
      }
    } else {
      for (const int child : {clusters[k].child, clusters[k].child + 1})
        include(boxes[child].low, boxes[child].high);
    }
    boxes[k] = box;
  }
  return tree;
}

// To the box of a cluster; a little less, so that rounding never hides a triangle that is equally
// close.
double TriangleTree::squared_distance(int cluster, const Vector3d& p) const {
  constexpr double slack = 1 - 1e-12;
  const Box& box = boxes_[cluster];
  const Vector3d way = (box.low - p).cwiseMax(p - box.high).cwiseMax(Vector3d::Zero());
  return slack * way.squaredNorm();
}

void TriangleTree::try_triangle(int triangle, const Vector3d& p, Found& found) const {
  Triangle corners;
  for (int k = 0; k < 3; ++k) corners[k] = points_.row(triangles_[triangle][k]).transpose();
  found.try_triangle(triangle, corners, p);
}

ClosestPoint TriangleTree::closest(const Vector3d& p, int near) const {
  Found found;
  found.place.triangle = near;
  try_triangle(near, p, found);
  std::vector<std::pair<double, int>> open = {{squared_distance(0, p), 0}};
  while (!open.empty()) {
    const auto [least, cluster] = open.back();
    open.pop_back();
    if (least > found.squared_distance) continue;
    const PointTree::Cluster& here = centres_.clusters()[cluster];
    if (here.is_leaf()) {
      for (int n = here.first; n < here.first + here.count; ++n)
        try_triangle(centres_.rows()[n], p, found);
      continue;
    }
    std::pair<double, int> first{squared_distance(here.child, p), here.child};
    std::pair<double, int> second{squared_distance(here.child + 1, p), here.child + 1};
    if (second < first) std::swap(first, second);
    open.push_back(second);
    open.push_back(first);
  }
  return found.place;
}

ClosestPoint TriangleTree::first_of_closest(const Vector3d& p, double tolerance) const {
  Found nearest;
  nearest.place = closest(p);
  try_triangle(nearest.place.triangle, p, nearest);
  const double most = std::sqrt(nearest.squared_distance) + tolerance;
  std::vector<int> open = {0};
  while (!open.empty()) {
    const int cluster = open.back();
    open.pop_back();
    if (std::sqrt(squared_distance(cluster, p)) > most) continue;
    const PointTree::Cluster& here = centres_.clusters()[cluster];
    if (!here.is_leaf()) {
      open.push_back(here.child);
      open.push_back(here.child + 1);
      continue;
    }
    for (int n = here.first; n < here.first + here.count; ++n) {
      Found one;
      one.place.triangle = centres_.rows()[n];
      if (one.place.triangle >= nearest.place.triangle) continue;
      try_triangle(one.place.triangle, p, one);
      if (std::sqrt(one.squared_distance) <= most) nearest.place = one.place;
    }
  }
  return nearest.place;
}

}  // namespace pliant
