#pragma once

#include "pliant/timeline/key.hpp"

namespace pliant::timeline {

/// The least and the greatest of values, per component [unit].
template <int D>
struct Bounds {
  Value<D> low = {};
  Value<D> high = {};

  /// Extends the bounds to a value, which must not be NaN.
  void add(const Value<D>& value) {
    for (int c = 0; c < D; ++c) {
      if (value[c] < low[c]) low[c] = value[c];
      if (value[c] > high[c]) high[c] = value[c];
    }
  }
  friend bool operator==(const Bounds&, const Bounds&) = default;
};

}  // namespace pliant::timeline
