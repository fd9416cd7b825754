#pragma once

#include <array>

#include "pliant/core/field.hpp"

namespace pliant {

/// Order in which the three rotations apply: `Xyz` turns about x first, so R = Rz Ry Rx.
enum class RotateOrder { Xyz, Xzy, Yxz, Yzx, Zxy, Zyx };

/// Position, rotation and scale of an object, as authored: p_world = translate + R S p.
struct Placement {
  Vector3d translate = {0, 0, 0};  ///< [length]
  Vector3d rotate = {0, 0, 0};     ///< about x, y and z [degrees]
  Vector3d scale = {1, 1, 1};      ///< [1]
  RotateOrder order = RotateOrder::Xyz;

  friend bool operator==(const Placement&, const Placement&) = default;
};

/// The axes in the order in which a rotation turns about them: 0 is x.
std::array<int, 3> axes(RotateOrder order);

/// An affine map from object to world space: p_world = linear p + translation.
struct Transform {
  Matrix3d linear{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};  ///< R S
  Vector3d translation = {0, 0, 0};                  ///< [length]

  /// Whether the inverse exists: no direction is collapsed.
  bool is_invertible() const;

  /// Whether it reflects: its determinant is negative, so that a face turns the other way round.
  bool is_mirrored() const;
};

/// T + R S p, right-handed. SPEC 7. `rotate_degrees` [degrees], `scale` [1].
Transform make_transform(const Vector3d& translate, const Vector3d& rotate_degrees,
                         const Vector3d& scale, RotateOrder order);

inline Transform make_transform(const Placement& placement) {
  return make_transform(placement.translate, placement.rotate, placement.scale, placement.order);
}

/// The product of two matrices, with sums of a fixed order.
Matrix3d product(const Matrix3d& a, const Matrix3d& b);

/// A point in world space. The order of the sum is fixed: (x + y + z) + translation.
inline Vector3d to_world(const Transform& transform, const Vector3d& point) {
  const Matrix3d& a = transform.linear;
  Vector3d world;
  for (int k = 0; k < 3; ++k) {
    const double turned = point[0] * a(k, 0) + point[1] * a(k, 1) + point[2] * a(k, 2);
    world[k] = turned + transform.translation[k];
  }
  return world;
}

/// Points (#points x 3) in world space, each as above. The result reuses the memory of `reuse`.
Field to_world(const Transform& transform, const Field& points, Field reuse = {});

/// Vectors (#vectors x 3) in world space: the linear part only.
Field vectors_to_world(const Transform& transform, const Field& vectors);

/// The matrix that maps world-space vectors to object space. Requires: is_invertible().
Matrix3d inverse_linear(const Transform& transform);

/// World-space vectors (#vectors x 3) in object space: each component is the sum of x, y and z
/// times the entries of a row of `inverse_linear`, added in this order. Requires: is_invertible().
Field vectors_to_object(const Transform& transform, const Field& vectors);

}  // namespace pliant
