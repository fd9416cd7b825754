#include "pliant/mesh/triangles/triangle_frame.hpp"

#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

double dot(const Vector3d& a, const Vector3d& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vector3d cross(const Vector3d& a, const Vector3d& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double length(const Vector3d& a) { return std::sqrt(dot(a, a)); }

// How little the two shorter edges may exceed the longest, relative to it.
constexpr double least_excess = 1e-8;

// The shortest part of an axis that may lie in a triangle.
constexpr double least_projection = 0.1;

// The smallest area of a triangle's UVs, relative to the square of its longer edge.
constexpr double least_uv_area = 1e-12;

struct Directions {
  Vector3d u, v;  // of length 1, in the triangle
};

// The two edges from the first corner, and the unit normal by the triangle's turn.
struct Plane {
  Vector3d ab, ac, normal;
};

std::optional<Directions> along_uvs(const Plane& plane, const TriangleUvs& uvs) {
  if (!uvs) return {};
  const auto& [a, b, c] = *uvs;
  const double ub = b[0] - a[0], vb = b[1] - a[1], uc = c[0] - a[0], vc = c[1] - a[1];
  const double determinant = ub * vc - uc * vb;
  const double longer = std::max(ub * ub + vb * vb, uc * uc + vc * vc);
  if (!(std::abs(determinant) > least_uv_area * longer)) return {};
  // The sign of the determinant; its size does not change a direction.
  const double sign = determinant > 0 ? 1 : -1;
  const Vector3d by_u = sign * (vc * plane.ab - vb * plane.ac);
  const Vector3d by_v = sign * (ub * plane.ac - uc * plane.ab);
  const Vector3d u = by_u / length(by_u);
  const Vector3d across = cross(plane.normal, u);
  return Directions{u, dot(across, by_v) < 0 ? Vector3d(-across) : across};
}

Directions along_axis(const Plane& plane, const Vector3d& axis) {
  for (const Vector3d& candidate : {axis, Vector3d(axis[2], axis[0], axis[1])}) {
    const Vector3d unit = candidate / length(candidate);
    const Vector3d projected = unit - dot(unit, plane.normal) * plane.normal;
    const double part = length(projected);
    if (part < least_projection) continue;
    const Vector3d u = projected / part;
    return {u, cross(plane.normal, u)};
  }
  const Vector3d u = plane.ab / length(plane.ab);
  return {u, cross(plane.normal, u)};
}

// A triangle of these edge lengths, ab, bc and ca, with u along the longest.
FlatTriangle from_lengths(const std::array<double, 3>& lengths) {
  const std::size_t longest =
      static_cast<std::size_t>(std::max_element(lengths.begin(), lengths.end()) - lengths.begin());
  const double base = lengths[longest];
  const double next = lengths[(longest + 1) % 3], last = lengths[(longest + 2) % 3];
  // The height by Kahan's stable form of Heron's formula; base >= the others.
  const double more = std::max(next, last), less = std::min(next, last);
  const double height = 0.5 / base *
                        std::sqrt((base + (more + less)) * (less - (base - more)) *
                                  (less + (base - more)) * (base + (more - less)));
  const double along = 0.5 * (base + (last - next) * ((last + next) / base));
  // The corners from the start of the longest edge on.
  std::array<std::array<double, 2>, 3> places;
  places[longest] = {0, 0};
  places[(longest + 1) % 3] = {base, 0};
  places[(longest + 2) % 3] = {along, height};
  const auto& [a, b, c] = places;
  return {{b[0] - a[0], b[1] - a[1]}, {c[0] - a[0], c[1] - a[1]}};
}

}  // namespace

FlatTriangle flattened(const std::array<Vector3d, 3>& corners, const TriangleUvs& uvs,
                       const std::optional<Vector3d>& axis) {
  const auto& [a, b, c] = corners;
  std::array<double, 3> lengths = {length(b - a), length(c - b), length(a - c)};
  const double longest = std::max({lengths[0], lengths[1], lengths[2]});
  const double excess = (lengths[0] - longest) + lengths[1] + lengths[2] - longest;
  if (excess < least_excess * longest) {
    for (double& each : lengths) each += least_excess * longest - excess;
    return from_lengths(lengths);
  }
  Plane plane{b - a, c - a, {}};
  plane.normal = cross(plane.ab, plane.ac);
  plane.normal /= length(plane.normal);
  const std::optional<Directions> by_uvs = axis ? std::nullopt : along_uvs(plane, uvs);
  const auto [u, v] = by_uvs ? *by_uvs : along_axis(plane, axis.value_or(Vector3d(1, 0, 0)));
  return {{dot(plane.ab, u), dot(plane.ab, v)}, {dot(plane.ac, u), dot(plane.ac, v)}};
}

}  // namespace pliant
