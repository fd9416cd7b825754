#include "pliant/mesh/written/binding.hpp"

#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "pliant/mesh/triangles/triangle_tree.hpp"

namespace pliant {
namespace {

// Trials of triangles in the searches for closest points: what one costs, and how many there may
// be. A point inside a ball, half its radius deep, takes about the root of the number of triangles.
constexpr std::size_t parts_of_trial = 20, most_trials = 1'000'000, most_trials_of_point = 4096;

// A power of two, by which no coordinate of these is larger than 1.
double scale_of(const Field& a, const Field& b) {
  const double most = std::max(a.cwiseAbs().maxCoeff(), b.size() > 0 ? b.cwiseAbs().maxCoeff() : 0);
  int exponent = 0;
  std::frexp(most, &exponent);
  return std::ldexp(1.0, -exponent);
}

}  // namespace

Result<Binding> Binding::make(const TriangleSurface& driver, const Transform& transform,
                              const Field& points, const StopRequest& should_stop) {
  StopPoll poll(should_stop);
  Binding binding;
  binding.faces_ = FaceTriangles(driver, poll);
  if (!poll.after(0)) binding.rest_ = binding.faces_.with_centres(driver.rest, poll);
  if (!poll.after(0)) binding.take_gradients(poll);
  if (poll.after(0)) return interrupted();
  Field placed = to_world(transform, binding.rest_);
  const double scale = scale_of(placed, points);
  placed *= scale;
  const auto tree = TriangleTree::make(placed, binding.faces_.triangles, should_stop);
  if (!tree) return fail(tree.error());
  std::vector<int>& triangles = binding.triangles_of_points_;
  triangles.reserve(static_cast<std::size_t>(points.rows()));
  binding.weights_.reserve(static_cast<std::size_t>(points.rows()));
  std::size_t tried = 0;
  for (Eigen::Index k = 0; k < points.rows(); ++k) {
    const int near = k > 0 ? triangles.back() : 0;  // neighbours in a mesh are near
    const ClosestPoint closest = tree->closest(scale * points.row(k).transpose(), near);
    if (poll.after(2000 + parts_of_trial * closest.tried)) return interrupted();
    tried += closest.tried;
    if (tried > most_trials + most_trials_of_point * static_cast<std::size_t>(points.rows())) {
      return invalid(
          "the driven vertices are as far from thousands of triangles as from the closest one, "
          "like the centre of a sphere");
    }
    triangles.push_back(closest.triangle);
    binding.weights_.push_back(closest.weights);
  }
  return binding;
}

void Binding::take_gradients(StopPoll& poll) {
  areas_.setZero(faces_.node_count);
  gradients_.setZero(2 * static_cast<Eigen::Index>(faces_.triangles.size()), 3);
  for (std::size_t k = 0; k < faces_.triangles.size(); ++k) {
    if (poll.after(16)) return;
    const auto& [a, b, c] = faces_.triangles[k];
    const Vector3d along_b = (rest_.row(b) - rest_.row(a)).transpose();
    const Vector3d along_c = (rest_.row(c) - rest_.row(a)).transpose();
    const Vector3d normal = along_b.cross(along_c);
    const double size = normal.stableNorm();
    if (!(size > 0)) continue;  // a triangle without an area has no gradient
    const Vector3d half = normal / (2 * size);
    gradients_.row(2 * static_cast<Eigen::Index>(k)) = -half.cross(along_c).transpose();
    gradients_.row(2 * static_cast<Eigen::Index>(k) + 1) = half.cross(along_b).transpose();
    for (const int corner : faces_.triangles[k])
      if (corner < faces_.node_count) areas_[corner] += size / 2;
  }
}

Result<Field> Binding::displacements(const Field& nodes, Field reuse,
                                     const StopRequest& should_stop) const {
  StopPoll poll(should_stop);
  // Nine components of G, the derivatives of w by x, then by y, then by z, after the three of w.
  Eigen::Matrix<double, Eigen::Dynamic, 12, Eigen::RowMajor> values(rest_.rows(), 12);
  values.setZero();
  values.topLeftCorner(faces_.node_count, 3) = nodes;
  const auto mean_of_corners = [&](int first, int count) {
    for (int centre = 0; centre < faces_.centre_count() && !poll.after(16); ++centre) {
      const int begin = faces_.centre_starts[centre], end = faces_.centre_starts[centre + 1];
      auto mean = values.row(faces_.node_count + centre).segment(first, count);
      for (int k = begin; k < end; ++k)
        mean += values.row(faces_.centre_nodes[k]).segment(first, count);
      mean /= end - begin;
    }
  };
  mean_of_corners(0, 3);
  for (std::size_t k = 0; k < faces_.triangles.size(); ++k) {
    if (poll.after(16)) return interrupted();
    const auto& [a, b, c] = faces_.triangles[k];
    const Eigen::RowVector3d to_b = values.row(b).head<3>() - values.row(a).head<3>();
    const Eigen::RowVector3d to_c = values.row(c).head<3>() - values.row(a).head<3>();
    Eigen::Matrix<double, 1, 9> gradient;
    for (int axis = 0; axis < 3; ++axis) {
      gradient.segment<3>(3 * axis) = gradients_(2 * static_cast<Eigen::Index>(k), axis) * to_b +
                                      gradients_(2 * static_cast<Eigen::Index>(k) + 1, axis) * to_c;
    }
    for (const int corner : faces_.triangles[k])
      if (corner < faces_.node_count) values.row(corner).tail<9>() += gradient;
  }
  for (int node = 0; node < faces_.node_count; ++node) {
    if (poll.after(4)) return interrupted();
    if (areas_[node] > 0) values.row(node).tail<9>() /= areas_[node];
  }
  mean_of_corners(3, 9);
  reuse.setZero(point_count(), 3);
  for (int point = 0; point < point_count(); ++point) {
    if (poll.after(32)) return interrupted();
    const FaceTriangles::Corners& corners = faces_.triangles[triangles_of_points_[point]];
    const std::array<double, 3>& weights = weights_[point];
    Eigen::RowVector3d q = Eigen::RowVector3d::Zero();
    for (int k = 0; k < 3; ++k) q += weights[k] * rest_.row(corners[k]);
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      const auto at_corner = values.row(corners[k]);
      const Eigen::RowVector3d way = 0.5 * (q - rest_.row(corners[k]));
      Eigen::RowVector3d bent = at_corner.head<3>();
      for (int axis = 0; axis < 3; ++axis) bent += way[axis] * at_corner.segment<3>(3 + 3 * axis);
      sum += weights[k] * bent;
    }
    reuse.row(point) = sum;
  }
  return reuse;
}

}  // namespace pliant
