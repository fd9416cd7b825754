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
  Vector3d normal;  ///< there
  Vector3d place;   ///< of the node there
};

/// A node goes straight from `x0` to `x1` in the frame of a solid that changes evenly from `from`
/// to `to`: where it first comes as near as the offset, at once if it begins there; null if it
/// comes nowhere nearer than that by more than `slack`. The distance is a convex function of time,
/// since support, place and offset change evenly: Newton's method on it does not pass its first
/// zero.
std::optional<Contact> first_contact(const Kept& from, const Kept& to, const Vector3d& x0,
                                     const Vector3d& x1, double slack);

}  // namespace pliant
