#pragma once

#include "pliant/core/transform.hpp"
#include "pliant/timeline/key.hpp"

namespace pliant::exchange {

/// A quaternion x y z w, as glTF has it; of any length but 0.
using Quaternion = Value<4>;

/// The rotation about x, y and z [degrees], of all that turn alike the nearest to `near`. Where the
/// middle angle is ±90 degrees the first one is that of `near`.
Value<3> euler_near(const Quaternion& rotation, RotateOrder order, const Value<3>& near);

/// The unit quaternion of angles [degrees]; of both, the nearer to `near`.
Quaternion quaternion_near(const Value<3>& degrees, RotateOrder order, const Quaternion& near);

}  // namespace pliant::exchange
