#include "pliant/mesh/triangles/triangulate.hpp"

#include <numeric>

#include <Eigen/Geometry>

#include "pliant/mesh/triangles/polygon_sweep.hpp"

namespace pliant {
namespace {

using Vector2d = Eigen::Vector2d;
using CornerTriples = std::vector<std::array<int, 3>>;

// The most corners of a face that is cut at its ears, which takes their third power.
constexpr int most_for_ears = 32;

// The corners of a face projected along its mean normal, counter-clockwise.
std::vector<Vector2d> laid_flat(const Mesh& mesh, int first, int size) {
  const auto at = [&](int k) -> Vector3d {
    return mesh.positions.row(
        mesh.corner_vertices[static_cast<std::size_t>(first) + static_cast<std::size_t>(k)]);
  };
  Vector3d normal = Vector3d::Zero();
  for (int k = 1; k + 1 < size; ++k) normal += (at(k) - at(0)).cross(at(k + 1) - at(0));
  int axis = 0;  // the axis to drop: the one nearest to the normal
  normal.cwiseAbs().maxCoeff(&axis);
  const int x = (axis + 1) % 3, y = (axis + 2) % 3;
  const double sign = normal[axis] < 0 ? -1 : 1;
  std::vector<Vector2d> points;
  for (int k = 0; k < size; ++k) {
    const Vector3d point = at(k) - at(0);
    points.emplace_back(point[x], sign * point[y]);
  }
  return points;
}

// Whether a triangle can be cut off: it has the right orientation and contains no other corner.
bool is_ear(const std::vector<Vector2d>& points, const std::vector<int>& left, std::size_t tip) {
  const std::size_t n = left.size();
  const std::size_t before = (tip + n - 1) % n, after = (tip + 1) % n;
  const auto at = [&](std::size_t k) -> const Vector2d& {
    return points[static_cast<std::size_t>(left[k])];
  };
  const Vector2d &a = at(before), &b = at(tip), &c = at(after);
  if (!(turn(a, b, c) > 0)) return false;
  for (std::size_t k = 0; k < n; ++k) {
    if (k == before || k == tip || k == after) continue;
    const Vector2d& p = at(k);
    if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
  }
  return true;
}

CornerTriples fan(int size) {
  CornerTriples triangles;
  for (int k = 1; k + 1 < size; ++k) triangles.push_back({0, k, k + 1});
  return triangles;
}

bool is_fan(const std::vector<Vector2d>& points) {
  for (std::size_t k = 1; k + 1 < points.size(); ++k)
    if (!(turn(points[0], points[k], points[k + 1]) > 0)) return false;
  return true;
}

CornerTriples ears(const std::vector<Vector2d>& points) {
  CornerTriples triangles;
  std::vector<int> left(points.size());
  std::iota(left.begin(), left.end(), 0);
  while (left.size() > 3) {
    const std::size_t n = left.size();
    std::size_t tip = 1;
    for (std::size_t k = 0; k < n; ++k) {
      if (!is_ear(points, left, (k + 1) % n)) continue;
      tip = (k + 1) % n;
      break;
    }
    const std::size_t before = (tip + n - 1) % n, after = (tip + 1) % n;
    triangles.push_back({left[before], left[tip], left[after]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(tip));
  }
  triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

CornerTriples triangles_of(const Mesh& mesh, int first, int size) {
  if (size == 3) return fan(size);
  const std::vector<Vector2d> points = laid_flat(mesh, first, size);
  if (size <= most_for_ears) return ears(points);
  if (is_fan(points)) return fan(size);
  return swept_triangles(points).value_or(fan(size));
}

}  // namespace

CornerTriples triangulate(const Mesh& mesh) {
  const StopRequest never;
  StopPoll poll(never);
  return triangulate(mesh, poll);
}

CornerTriples triangulate(const Mesh& mesh, StopPoll& poll) {
  CornerTriples triangles;
  triangles.reserve(mesh.corner_vertices.size() - 2 * mesh.face_sizes.size());
  int first = 0;
  for (const int size : mesh.face_sizes) {
    if (poll.after(32 * static_cast<std::size_t>(size))) break;
    for (const auto& [a, b, c] : triangles_of(mesh, first, size))
      triangles.push_back({first + a, first + b, first + c});
    first += size;
  }
  return triangles;
}

}  // namespace pliant
