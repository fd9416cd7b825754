#pragma once

#include <optional>
#include <variant>

#include "pliant/core/field.hpp"
#include "pliant/forces/falloff.hpp"

namespace pliant {

// A force at one frame: its parameters sampled, in world space. Pure functions of a position.
// SPEC 7. For a kind of force, `distance` is what selects and `direction` the unit vector along
// which it pushes; the force on a node is magnitude x falloff(distance / force radius) x direction.

/// The thesis's force (5.2.2): a sphere around `center` that pushes along one direction.
struct PointForce {
  Vector3d center = Vector3d::Zero();      ///< world [length]
  Vector3d direction = Vector3d::UnitY();  ///< any length; zero: no force
};

/// Pushes away from `center`.
struct RadialForce {
  Vector3d center = Vector3d::Zero();  ///< world [length]
};

/// Acts around the segment from..to, along `direction` or, without one, away from the segment.
struct LineForce {
  Vector3d from = Vector3d::Zero();        ///< world [length]
  Vector3d to = Vector3d::UnitX();         ///< world [length]; may equal `from`
  std::optional<Vector3d> direction = {};  ///< any length; zero: no force
};

using ForceShape = std::variant<PointForce, RadialForce, LineForce>;

/// A force at one frame.
struct SampledForce {
  ForceShape shape;
  double magnitude = 0;           ///< [length b/uv^4]
  double deformation_radius = 1;  ///< [length], >= 0
  double force_radius = 1;        ///< [length], >= 0
  Falloff falloff = Falloff::Constant;
};

/// Distance from p that selects: to the centre, or to the closest point of the segment. [length]
double distance(const ForceShape& shape, const Vector3d& p);

/// Unit vector along which the force pushes at p, or zero: for a direction of length 0, at the
/// centre of a radial force, and on the segment of a line force without direction.
Vector3d direction(const ForceShape& shape, const Vector3d& p);

/// The force on a node at p, wherever p lies: the force box is the caller's concern.
/// Requires: force_radius > 0. [length b/uv^4]
Vector3d force_at(const SampledForce& force, const Vector3d& p);

}  // namespace pliant
