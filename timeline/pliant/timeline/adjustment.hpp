#pragma once

#include <array>

#include "pliant/timeline/key.hpp"

namespace pliant {

/// What is done to a number after its curve is evaluated, so that its timing stays: one rounding.
struct Adjustment {
  enum class Kind {
    Keep,
    Set,    ///< the number itself, at every frame
    Times,  ///< the curve's value times it
    Plus,   ///< the curve's value plus it
  };
  Kind kind = Kind::Keep;
  double number = 0;  ///< finite; of Times [1], otherwise [unit]

  double of_value(double value) const {
    switch (kind) {
      case Kind::Set:
        return number;
      case Kind::Times:
        return value * number;
      case Kind::Plus:
        return value + number;
      case Kind::Keep:
        break;
    }
    return value;
  }

  /// Of a difference of two values, such as a slope.
  double of_difference(double difference) const {
    switch (kind) {
      case Kind::Set:
        return 0;
      case Kind::Times:
        return difference * number;
      case Kind::Plus:
      case Kind::Keep:
        break;
    }
    return difference;
  }

  friend bool operator==(const Adjustment&, const Adjustment&) = default;
};

/// One for each component.
template <int D>
using Adjustments = std::array<Adjustment, D>;

template <int D>
Value<D> adjusted_value(const Adjustments<D>& adjustments, Value<D> value) {
  for (int c = 0; c < D; ++c) value[c] = adjustments[c].of_value(value[c]);
  return value;
}

template <int D>
Value<D> adjusted_difference(const Adjustments<D>& adjustments, Value<D> difference) {
  for (int c = 0; c < D; ++c) difference[c] = adjustments[c].of_difference(difference[c]);
  return difference;
}

/// Whether both adjust a component.
template <int D>
bool overlap(const Adjustments<D>& a, const Adjustments<D>& b) {
  for (int c = 0; c < D; ++c) {
    if (a[c].kind != Adjustment::Kind::Keep && b[c].kind != Adjustment::Kind::Keep) return true;
  }
  return false;
}

/// Both. Requires: they do not overlap.
template <int D>
Adjustments<D> both(Adjustments<D> a, const Adjustments<D>& b) {
  for (int c = 0; c < D; ++c) {
    if (b[c].kind != Adjustment::Kind::Keep) a[c] = b[c];
  }
  return a;
}

}  // namespace pliant
