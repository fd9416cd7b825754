#pragma once

#include "pliant/contact/way.hpp"
#include "pliant/core/transform.hpp"

namespace pliant {

/// A collider at one moment, in the world.
struct PlacedCollider {
  Matrix3d rotation = Matrix3d::Identity();  ///< of its frame, in which its solid is
  Vector3d translation = {0, 0, 0};          ///< [length]
  Kept kept = {};
  double mesh_way =
      0;  ///< no point of its mesh went farther in its frame, since the frame [length]

  Vector3d to_frame(const Vector3d& world) const;
  Vector3d to_world(const Vector3d& x) const;
  Vector3d turned(const Vector3d& direction) const;  ///< from its frame to the world
};

/// What is keyed of where a collider is, at one frame.
struct ColliderPose {
  Solid shape;  ///< without the placement's scale
  Placement
      placement;      ///< the scale of a sphere or capsule is the same along all axes, up to signs
  double offset = 0;  ///< >= 0, that nodes keep from it [length]

  friend bool operator==(const ColliderPose&, const ColliderPose&) = default;
};

/// A solid that a surface meets on the way from one frame to the next.
struct SampledCollider {
  ColliderPose first, last;
  double deformation_radius = 0;  ///< of what it selects, >= 0; 0: nothing [length]
  double friction = 0;            ///< mu >= 0 [1]
  bool sticks = false;            ///< what touches it is held
  int index = 0;                  ///< in the scene: whom facts are about
};

/// The collider at part `a` of its way: each number of its pose (1 - a) of the first and a of the
/// last.
PlacedCollider placed(const SampledCollider& collider, double a);

/// Whether it is a mesh whose points move in its frame: then `placed` makes a pose of it.
bool has_moving_mesh(const SampledCollider& collider);

/// No point of its mesh goes farther in its frame, on the way to the next frame. [length]
double mesh_way_of(const SampledCollider& collider);

/// A placement between two, number by number.
Placement between(const Placement& first, const Placement& last, double a);

}  // namespace pliant
