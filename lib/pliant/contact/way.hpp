#pragma once

#include <optional>

#include "pliant/contact/solid.hpp"

namespace pliant {

/// A solid and the distance that nodes keep from it.
struct Kept {
  Solid solid;
  double offset = 0;  ///< >= 0 [length]
};

/// Signed distance to the solid, less the offset.
Nearness nearness(const Kept& kept, const Vector3d& x);

/// The first contact of a node on its way.
struct Contact {
  Vector3d normal;     ///< there
  Vector3d place;      ///< of the node, which the solid carries to the end of the way
  double support = 0;  ///< of the solid at the end of the way along the normal; of a mesh, of the
                       ///< place that was touched [length]
};

/// What is known of a mesh where a way to it begins.
struct MeshBegin {
  int near = -1;                        ///< a triangle that is near; -1: none
  std::optional<double> distance = {};  ///< signed, without the offset [length]
};

/// A node goes straight from `x0` to `x1` in the frame of a solid that changes evenly from `from`
/// to `to`: where it first comes as near as the offset, at once if it begins there; null if it
/// comes nowhere nearer than that by more than `slack`. The distance to a convex solid is a convex
/// function of time, since support, place and offset change evenly: Newton's method on it does not
/// pass its first zero. That to a mesh is the least of those to its triangles; `begin` is what is
/// known of it at `x0`.
std::optional<Contact> first_contact(const Kept& from, const Kept& to, const Vector3d& x0,
                                     const Vector3d& x1, double slack, const MeshBegin& begin = {});

/// The contact of a node that is as near to a solid at the beginning as `near`; null: it is not.
std::optional<Contact> lying_contact(const Kept& from, const Kept& to, const Vector3d& x,
                                     double near);

}  // namespace pliant
