#include "pliant/exchange/rotations.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace pliant::exchange {
namespace {

constexpr double to_degrees = 180 / std::numbers::pi;

double turned_near(double degrees, double near) {
  return degrees + 360 * std::round((near - degrees) / 360);
}

double squared_distance(const Value<3>& a, const Value<3>& b) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
  return sum;
}

Matrix3d matrix_of(const Quaternion& rotation) {
  return Eigen::Quaterniond(rotation[3], rotation[0], rotation[1], rotation[2])
      .normalized()
      .toRotationMatrix();
}

}  // namespace

// R = Rk(c) Rj(b) Ri(a), so that R(k,i) = -e sin b, R(k,j) = e cos b sin a, R(k,k) = cos b cos a,
// R(j,i) = e sin c cos b, R(i,i) = cos c cos b, with e = 1 if i, j, k follow each other as x, y, z
// do, and -1 otherwise. Source: Shoemake, Euler angle conversion, Graphics Gems IV.
Value<3> euler_near(const Quaternion& rotation, RotateOrder order, const Value<3>& near) {
  const auto [i, j, k] = axes(order);
  const double e = (i + 1) % 3 == j ? 1 : -1;
  const auto at = [](int axis) { return static_cast<std::size_t>(axis); };
  Matrix3d matrix = matrix_of(rotation);
  const double level = std::hypot(matrix(k, j), matrix(k, k));
  Value<3> angles{};
  angles[at(j)] = std::atan2(-e * matrix(k, i), level) * to_degrees;
  if (level > 1e-9) {
    angles[at(i)] = std::atan2(e * matrix(k, j), matrix(k, k)) * to_degrees;
    angles[at(k)] = std::atan2(e * matrix(j, i), matrix(i, i)) * to_degrees;
  } else {
    Value<3> back{};
    back[at(i)] = -near[at(i)];
    const Matrix3d rest =
        matrix * make_transform({0, 0, 0}, {back[0], back[1], back[2]}, {1, 1, 1}, order).linear;
    angles[at(i)] = near[at(i)];
    angles[at(k)] = std::atan2(-e * rest(i, j), rest(j, j)) * to_degrees;
  }
  Value<3> other = angles;  // turns alike
  other[at(i)] += 180;
  other[at(j)] = 180 - other[at(j)];
  other[at(k)] += 180;
  for (std::size_t c = 0; c < 3; ++c) {
    angles[c] = turned_near(angles[c], near[c]);
    other[c] = turned_near(other[c], near[c]);
  }
  return squared_distance(other, near) < squared_distance(angles, near) ? other : angles;
}

Quaternion quaternion_near(const Value<3>& degrees, RotateOrder order, const Quaternion& near) {
  const Eigen::Quaterniond turn(
      make_transform({0, 0, 0}, {degrees[0], degrees[1], degrees[2]}, {1, 1, 1}, order).linear);
  Quaternion result{turn.x(), turn.y(), turn.z(), turn.w()};
  double dot = 0;
  for (std::size_t c = 0; c < 4; ++c) dot += result[c] * near[c];
  if (dot < 0)
    for (double& each : result) each = -each;
  return result;
}

Quaternion slerp(const Quaternion& from, const Quaternion& to, double share) {
  const auto unit = [](const Quaternion& q) {
    return Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized();
  };
  const Eigen::Quaterniond turn = unit(from).slerp(share, unit(to));
  return {turn.x(), turn.y(), turn.z(), turn.w()};
}

}  // namespace pliant::exchange
