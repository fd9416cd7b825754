#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <tuple>
#include <variant>

#include "pliant/core/field.hpp"
#include "pliant/forces/falloff.hpp"
#include "pliant/forces/position_function.hpp"
#include "pliant/timeline/curve.hpp"

namespace pliant {

// A force at one frame: its parameters sampled, in world space. Pure functions of a position. SPEC
// 7. Every kind has two functions of a position p [length]:
//   distance(p)    decides which nodes are selected, >= 0 [length]
//   unit_force(p)  the force per unit of magnitude and falloff; for most kinds a unit vector or 0
// and `values()`, all its members.
// The force on a node is magnitude x falloff(distance / force radius) x unit_force.

/// The thesis's force (5.2.2): a sphere around `center` that pushes along one direction.
struct PointForce {
  Vector3d center = {0, 0, 0};     ///< world [length]
  Vector3d direction = {0, 1, 0};  ///< any length; zero: no force

  auto values() const { return std::tie(center, direction); }
  double distance(const Vector3d& p) const;
  Vector3d unit_force(const Vector3d& p) const;
};

/// Pushes away from `center`, where it is 0.
struct RadialForce {
  Vector3d center = {0, 0, 0};  ///< world [length]

  auto values() const { return std::tie(center); }
  double distance(const Vector3d& p) const;
  Vector3d unit_force(const Vector3d& p) const;
};

/// Acts around the segment from..to, along `direction`; without one, away from the segment, and 0
/// on the segment.
struct LineForce {
  Vector3d from = {0, 0, 0};               ///< world [length]
  Vector3d to = {1, 0, 0};                 ///< world [length]; may equal `from`
  std::optional<Vector3d> direction = {};  ///< any length; zero: no force

  auto values() const { return std::tie(from, to, direction); }
  double distance(const Vector3d& p) const;  ///< to the closest point of the segment
  Vector3d unit_force(const Vector3d& p) const;
};

/// The same everywhere, like gravity: every distance is 0.
struct UniformForce {
  Vector3d direction = {0, 1, 0};  ///< any length; zero: no force

  auto values() const { return std::tie(direction); }
  double distance(const Vector3d& p) const;
  Vector3d unit_force(const Vector3d& p) const;
};

/// Rotates about the line through `center` along `axis`, by the right-hand rule, and pulls towards
/// it; 0 on the line itself. With an `axis` of length 0 the force is 0, and distances are to
/// `center`.
struct VortexForce {
  Vector3d center = {0, 0, 0};  ///< world [length]
  Vector3d axis = {0, 1, 0};    ///< any length
  double pull = 0;              ///< inward part, relative to the rotating part; < 0: outward

  auto values() const { return std::tie(center, axis, pull); }
  double distance(const Vector3d& p) const;      ///< to the line
  Vector3d unit_force(const Vector3d& p) const;  ///< of length sqrt(1 + pull^2)
};

/// Varies in space and time: `smooth_noise` on a lattice that has a corner at `center`.
struct NoiseForce {
  Vector3d center = {0, 0, 0};  ///< world [length]
  double frequency = 1;         ///< [cells/length]
  double time = 0;              ///< [cells]
  std::uint64_t seed = 0;
  std::optional<Matrix3d> turn = {};  ///< the rotation of the pattern and its vectors; null: none

  auto values() const { return std::tie(center, frequency, time, seed, turn); }
  double distance(const Vector3d& p) const;      ///< to the centre
  Vector3d unit_force(const Vector3d& p) const;  ///< components in [-1, 1]
};

/// The inertial load of a surface's own motion; every distance is 0. An affine function, offset +
/// linear (p - origin), and of a rest shape that is animated a vector for each node.
struct InertiaForce {
  Matrix3d linear = Matrix3d::Zero();
  Vector3d origin = {0, 0, 0};  ///< world [length]
  Vector3d offset = {0, 0, 0};
  std::shared_ptr<const Field> of_nodes = {};  ///< #nodes x 3, world; null: none

  auto values() const { return std::tie(linear, origin, offset, of_nodes); }
  double distance(const Vector3d& p) const;
  Vector3d unit_force(const Vector3d& p) const;  ///< without that of nodes
};

/// Pushes along the normals of a surface: inflates it, or sucks it in if it is negative. SPEC 7.
struct PressureForce {
  Vector3d center = {0, 0, 0};  ///< world [length]

  auto values() const { return std::tie(center); }
  double distance(const Vector3d& p) const;
  Vector3d unit_force(const Vector3d& p) const;  ///< 0: a position has no normal
};

/// A kind of force of an embedding program, at one frame. Requires: neither function is empty.
struct SampledCustomForce {
  /// None: a program identifies its functions by `CustomForce::key`.
  std::tuple<> values() const { return {}; }

  PositionFunction<double> distance;
  PositionFunction<Vector3d> unit_force;
  bool is_of_many = true;  ///< whether the program's functions are, so that few calls are best
};

using ForceKind = std::variant<PointForce, RadialForce, LineForce, UniformForce, VortexForce,
                               NoiseForce, InertiaForce, PressureForce, SampledCustomForce>;

/// A force at one frame.
struct SampledForce {
  ForceKind kind;
  double magnitude = 0;           ///< [length b/uv^4]
  double deformation_radius = 1;  ///< [length], >= 0; 0: selects no region
  double force_radius = 1;        ///< [length], >= 0; 0: pushes nothing
  Falloff falloff = Falloff::Constant;
  /// An authored curve over s = distance / force radius that replaces `falloff`; for s > 1 its
  /// value at 1 is used. Null: `falloff`. Owned by the scene.
  const Curve<1>* falloff_curve = nullptr;
  /// Only the part of the unit force along the normal of the node pushes it. SPEC 7.
  bool is_along_normal = false;
};

/// Whether the force on a node depends on its normal.
inline bool uses_normals(const SampledForce& force) {
  return force.is_along_normal || std::holds_alternative<PressureForce>(force.kind);
}

/// Whether a program's own functions compute the force.
inline bool is_own(const SampledForce& force) {
  return std::holds_alternative<SampledCustomForce>(force.kind);
}

/// A sphere that selects a region and pushes nothing, as a group does. The forces in the group have
/// a deformation radius of 0, so that "strictly less" selects nothing for them. SPEC 7.
SampledForce region_sphere(const Vector3d& center, double deformation_radius);

/// Distance from p that decides the selection. [length]
double distance(const ForceKind& force, const Vector3d& p);

/// The force at p per unit of magnitude and falloff.
Vector3d unit_force(const ForceKind& force, const Vector3d& p);

/// The force on a node at p, for any p: the caller checks the force box. Requires: force_radius >
/// 0, and not `uses_normals`. [length b/uv^4]
Vector3d force_at(const SampledForce& force, const Vector3d& p);

/// The same on a node of a surface at p, by its number, with what the force has for that node.
/// `normal`: of the node, world; of length 1 or 0. Used only if `uses_normals`.
Vector3d force_on(const SampledForce& force, const Vector3d& p, int node, const Vector3d& normal);

}  // namespace pliant
