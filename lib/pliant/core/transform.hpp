#pragma once

#include <array>

#include "pliant/core/field.hpp"

namespace pliant {

/// Order in which the three rotations apply: `Xyz` turns about x first, so R = Rz Ry Rx.
enum class RotateOrder { Xyz, Xzy, Yxz, Yzx, Zxy, Zyx };

/// Where an object stands, as its author says it: p_world = translate + R S p.
struct Placement {
  Vector3d translate = Vector3d::Zero();  ///< [length]
  Vector3d rotate = Vector3d::Zero();     ///< about x, y and z [degrees]
  Vector3d scale = Vector3d::Ones();      ///< [1]
  RotateOrder order = RotateOrder::Xyz;

  friend bool operator==(const Placement&, const Placement&) = default;
};

/// The axes in the order in which a rotation turns about them: 0 is x.
std::array<int, 3> axes(RotateOrder order);

/// An affine map from object to world space: p_world = linear p + translation.
struct Transform {
  Matrix3d linear = Matrix3d::Identity();   ///< R S
  Vector3d translation = Vector3d::Zero();  ///< [length]

  /// Whether every direction survives: the inverse exists.
  bool is_invertible() const;
};

/// T + R S p, right-handed. SPEC 7. `rotate_degrees` [degrees], `scale` [1].
Transform make_transform(const Vector3d& translate, const Vector3d& rotate_degrees,
                         const Vector3d& scale, RotateOrder order);

inline Transform make_transform(const Placement& placement) {
  return make_transform(placement.translate, placement.rotate, placement.scale, placement.order);
}

/// Points (#points x 3) to world space. The sums have a stated order: (x + y + z) + translation.
Field to_world(const Transform& transform, const Field& points);

/// Vectors (#vectors x 3) to world space: the linear part only.
Field vectors_to_world(const Transform& transform, const Field& vectors);

/// World-space vectors (#vectors x 3) to object space, through the inverse linear part.
/// Requires: is_invertible().
Field vectors_to_object(const Transform& transform, const Field& vectors);

}  // namespace pliant
