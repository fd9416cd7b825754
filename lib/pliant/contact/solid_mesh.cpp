#include "pliant/contact/solid_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>

namespace pliant {
namespace {

// Triangles of a leaf.
constexpr int most_of_leaf = 4;

using Corners = SolidMesh::Corners;
using Triangle = PosedMesh::Triangle;

// A side of a triangle, as an edge between two points.
struct Side {
  std::pair<int, int> edge;  // the lower point first
  int corner;                // three times the triangle, and its corner
  bool is_upward;            // it runs from the lower point to the higher

  friend bool operator<(const Side& a, const Side& b) {
    return a.edge != b.edge ? a.edge < b.edge : a.corner < b.corner;
  }
};

std::vector<Side> sides_of(std::span<const Corners> triangles) {
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    for (int corner = 0; corner < 3; ++corner) {
      const int a = triangles[k][corner], b = triangles[k][(corner + 1) % 3];
      sides.push_back({std::minmax(a, b), static_cast<int>(3 * k) + corner, a < b});
    }
  }
  std::ranges::sort(sides, std::less<>());
  return sides;
}

// Six times the volume, about the first point.
double volume_of(std::span<const Corners> triangles, const Field& points) {
  const Vector3d origin = points.row(triangles[0][0]).transpose();
  double sum = 0;
  for (const Corners& corners : triangles) {
    Triangle at;
    for (int k = 0; k < 3; ++k) at[k] = points.row(corners[k]).transpose() - origin;
    sum += dot_of(at[0], cross_of(at[1], at[2]));
  }
  return sum;
}

}  // namespace

std::optional<OpenEdge> SolidMesh::open_edge(std::span<const Corners> triangles) {
  const std::vector<Side> sides = sides_of(triangles);
  std::optional<OpenEdge> first;
  int first_corner = 0;
  for (std::size_t begin = 0; begin < sides.size();) {
    std::size_t end = begin;
    while (end < sides.size() && sides[end].edge == sides[begin].edge) ++end;
    const bool is_closed = end - begin == 2 && sides[begin].is_upward != sides[begin + 1].is_upward;
    if (!is_closed && (!first || sides[begin].corner < first_corner)) {
      auto [from, to] = sides[begin].edge;
      if (!sides[begin].is_upward) std::swap(from, to);
      first = OpenEdge{from, to, static_cast<int>(end - begin)};
      first_corner = sides[begin].corner;
    }
    begin = end;
  }
  return first;
}

Result<std::shared_ptr<const SolidMesh>> SolidMesh::make(std::vector<Corners> triangles,
                                                         const Field& points,
                                                         const StopRequest& should_stop) {
  if (volume_of(triangles, points) < 0) {
    for (Corners& corners : triangles) std::swap(corners[1], corners[2]);
  }
  auto made = std::shared_ptr<SolidMesh>(new SolidMesh());
  made->triangles_ = std::move(triangles);
  const std::vector<Corners>& all = made->triangles_;
  made->neighbours_.resize(all.size());
  const std::vector<Side> sides = sides_of(all);
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const int corner = sides[k].corner, other = sides[k ^ 1U].corner;
    made->neighbours_[corner / 3][corner % 3] = other / 3;
  }
  std::vector<int>& starts = made->corner_starts_;
  starts.assign(static_cast<std::size_t>(points.rows()) + 1, 0);
  for (const Corners& corners : all)
    for (const int point : corners) ++starts[point + 1];
  for (std::size_t k = 1; k < starts.size(); ++k) starts[k] += starts[k - 1];
  std::vector<int> next = starts;
  made->corners_of_points_.resize(3 * all.size());
  Field centres(static_cast<Eigen::Index>(all.size()), 3);
  for (std::size_t k = 0; k < all.size(); ++k) {
    Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
    for (int corner = 0; corner < 3; ++corner) {
      const int point = all[k][corner];
      made->corners_of_points_[next[point]++] = static_cast<int>(3 * k) + corner;
      centre += points.row(point) / 3;
    }
    centres.row(static_cast<Eigen::Index>(k)) = centre;
  }
  auto tree = PointTree::make(centres, should_stop, most_of_leaf);
  if (!tree) return fail(tree.error());
  made->tree_ = *std::move(tree);
  made->places_.resize(all.size());
  for (std::size_t k = 0; k < all.size(); ++k)
    made->places_[made->order()[k]] = static_cast<int>(k);
  const auto bytes = std::as_bytes(std::span(all));
  made->hash_ =
      hash_of(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  return std::shared_ptr<const SolidMesh>(std::move(made));
}

std::size_t SolidMesh::bytes(std::size_t triangles, std::size_t points, std::size_t poses) {
  // Corners, neighbours, places; sides and centres while it is made; clusters.
  constexpr std::size_t of_triangle = 2 * 12 + 3 * 4 + 8 + 3 * sizeof(Side) + 3 * 24 + 40;
  constexpr std::size_t of_posed_triangle = sizeof(Triangle) + sizeof(PosedMesh::Box);
  return triangles * (of_triangle + poses * of_posed_triangle) + points * (8 + poses * 24);
}

PosedMesh::PosedMesh(std::shared_ptr<const SolidMesh> mesh, Field points, bool is_mirrored)
    : mesh_(std::move(mesh)), points_(std::move(points)), is_mirrored_(is_mirrored) {
  const std::vector<int>& order = mesh_->order();
  triangles_.resize(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Corners& corners = mesh_->triangles()[order[k]];
    for (int c = 0; c < 3; ++c)
      for (int axis = 0; axis < 3; ++axis) triangles_[k][c][axis] = points_(corners[c], axis);
  }
  const std::vector<PointTree::Cluster>& clusters = mesh_->clusters();
  boxes_.resize(clusters.size());
  for (std::size_t k = clusters.size(); k-- > 0;) {  // children come after their parents
    const PointTree::Cluster& here = clusters[k];
    Box& box = boxes_[k];
    if (!here.is_leaf()) {
      const Box &one = boxes_[here.child], &other = boxes_[here.child + 1];
      box = {one.low.cwiseMin(other.low), one.high.cwiseMax(other.high)};
      continue;
    }
    box.low = box.high = triangles_[here.first][0];
    for (int n = here.first; n < here.first + here.count; ++n) {
      for (const Vector3d& corner : triangles_[n]) {
        box.low = box.low.cwiseMin(corner);
        box.high = box.high.cwiseMax(corner);
      }
    }
  }
}

std::shared_ptr<const PosedMesh> PosedMesh::scaled(const std::shared_ptr<const PosedMesh>& mesh,
                                                   const Vector3d& scale) {
  if (scale == Vector3d(1, 1, 1)) return mesh;
  const std::lock_guard lock(mesh->mutex_);
  if (!mesh->scaled_ || mesh->scale_ != scale) {
    const bool turns = scale[0] * scale[1] * scale[2] < 0;
    mesh->scaled_ = std::make_shared<const PosedMesh>(
        mesh->mesh_, mesh->points_ * scale.asDiagonal(), mesh->is_mirrored_ != turns);
    mesh->scale_ = scale;
  }
  return mesh->scaled_;
}

}  // namespace pliant
