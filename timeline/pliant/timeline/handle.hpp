#pragma once

#include "pliant/timeline/key.hpp"

namespace pliant {

/// A handle of a Bézier segment as it shapes the curve: automatic tangents worked out, lengths as
/// `overshoot` leaves them. From a key to the tip, which is a control point of the cubic.
template <int D>
struct KeyHandle {
  double key_frame = 0;     ///< of the key that it belongs to
  Value<D> key_value = {};  ///< on the handle's side: what the curve arrives with, for an `in`
  double frame = 0;         ///< of the tip
  Value<D> value = {};      ///< of the tip [unit]
};

}  // namespace pliant
