#pragma once

#include "pliant/timeline/key.hpp"

namespace pliant {

/// A handle of a Bézier segment as it shapes the curve, with automatic tangents computed and
/// lengths corrected by `overshoot`. From a key to the tip, which is a control point of the cubic.
template <int D>
struct KeyHandle {
  double key_frame = 0;     ///< of its key
  Value<D> key_value = {};  ///< on the handle's side: for an `in`, the limit from the left
  double frame = 0;         ///< of the tip
  Value<D> value = {};      ///< of the tip [unit]
};

}  // namespace pliant
