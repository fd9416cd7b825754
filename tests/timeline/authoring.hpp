#pragma once

#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "pliant/timeline/curve.hpp"

// Short functions for writing keys, and random keys.

namespace pliant::testing {

using TangentKind = Tangent<1>::Kind;
using SegmentKind = Interpolation::Kind;
using OutsideKind = Extrapolation<1>::Kind;

inline constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// The distance to the next number away from 0.
inline double ulp(double x) {
  return std::nextafter(std::fabs(x), std::numeric_limits<double>::infinity()) - std::fabs(x);
}

inline Tangent<1> of_kind(TangentKind kind) { return {.kind = kind}; }
inline Tangent<1> of_slope(double slope) { return {.kind = TangentKind::Slope, .slope = {slope}}; }
inline Tangent<1> of_slope(double slope, double length) {
  return {.kind = TangentKind::Slope, .slope = {slope}, .length = length};
}
inline Tangent<1> of_handle(double frames, double value) {
  return {.kind = TangentKind::Handle, .handle_frames = frames, .handle_value = {value}};
}
inline Interpolation of_segment(SegmentKind kind) { return {.kind = kind}; }
inline Interpolation of_ease(Ease ease, EaseSide side) {
  return {.kind = SegmentKind::Easing, .ease = ease, .side = side};
}

inline Key<1> key(double frame, double value, Interpolation next = {}) {
  return {.frame = frame, .value = {value}, .next = next};
}
/// A key with the same tangent on both sides.
inline Key<1> key(double frame, double value, const Tangent<1>& both) {
  return {.frame = frame, .value = {value}, .in = both, .out = both};
}
inline Key<1> with_left(Key<1> key, double left) {
  key.left = Value<1>{left};
  return key;
}

inline CurveKeys<1> with_kinds(const CurveKeys<1>& keys, TangentKind kind) {
  CurveKeys<1> result = keys;
  for (Key<1>& each : result.keys) each.in = each.out = of_kind(kind);
  return result;
}

inline Curve<1> make(std::vector<Key<1>> keys) {
  return Curve<1>::make({.keys = std::move(keys)}).value();
}
inline Curve<1> make(const CurveKeys<1>& keys) { return Curve<1>::make(keys).value(); }

inline double at(const Curve<1>& curve, double frame) { return curve.value(frame)[0]; }

/// A seeded source of random choices of an author.
class Whim {
 public:
  explicit Whim(std::uint64_t seed) : bits_(seed) {}

  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(bits_);
  }
  int upto(int last) { return std::uniform_int_distribution<int>(0, last)(bits_); }
  bool once_in(int n) { return upto(n - 1) == 0; }
  /// Sizes from 10^low to 10^high, uniform in the exponent.
  double size(double low, double high) { return std::pow(10.0, between(low, high)); }

  Tangent<1> tangent(bool is_out, double span) {
    Tangent<1> tangent;
    tangent.kind = static_cast<TangentKind>(upto(9));
    tangent.slope = {between(-5, 5)};
    if (once_in(2)) tangent.length = between(-0.1, 2) * span;
    tangent.handle_frames = (is_out ? 1 : -1) * between(-0.1, 2) * span;
    if (once_in(5)) tangent.handle_frames = 0;
    tangent.handle_value = {between(-5, 5)};
    return tangent;
  }

  Interpolation interpolation() {
    Interpolation next;
    next.kind = once_in(2) ? SegmentKind::Bezier : static_cast<SegmentKind>(upto(5));
    next.ease = static_cast<Ease>(upto(9));
    next.side = static_cast<EaseSide>(upto(2));
    if (once_in(2)) next.amplitude = between(0, 3);
    if (once_in(2)) next.period = between(0.5, 4);
    if (once_in(2)) next.back = between(0, 3);
    next.control = {between(0, 1), between(-1, 2), between(0, 1), between(-1, 2)};
    return next;
  }

  /// Keys with all kinds of segments, tangents, jumps and outsides.
  CurveKeys<1> keys(int most) {
    CurveKeys<1> keys;
    double frame = between(-20, 20);
    const int count = 1 + upto(most - 1);
    double span = size(-2, 1.5);
    for (int k = 0; k < count; ++k) {
      Key<1> next;
      next.frame = frame;
      next.value = {once_in(4) && k > 0 ? keys.keys.back().value[0] : between(-10, 10)};
      next.next = interpolation();
      next.in = tangent(false, span);
      span = size(-2, 1.5);
      next.out = tangent(true, span);
      if (once_in(6)) next.left = Value<1>{between(-10, 10)};
      keys.keys.push_back(next);
      frame += span;
    }
    keys.before = outside();
    keys.after = outside();
    keys.overshoot = static_cast<Overshoot>(upto(2));
    return keys;
  }

  Extrapolation<1> outside() {
    Extrapolation<1> outside;
    outside.kind = static_cast<OutsideKind>(upto(6));
    outside.slope = {between(-2, 2)};
    if (once_in(2)) outside.count = 1 + upto(4);
    return outside;
  }

 private:
  std::mt19937_64 bits_;
};

/// Keys as those of `Whim`, of vectors.
inline CurveKeys<3> vector_keys(Whim& whim, int most) {
  const CurveKeys<1> numbers = whim.keys(most);
  const auto widened = [&](const Value<1>& value) {
    return Value<3>{value[0], whim.between(-5, 5), whim.once_in(2) ? value[0] : 0};
  };
  const auto tangent = [&](const Tangent<1>& of) {
    return Tangent<3>{.kind = static_cast<Tangent<3>::Kind>(of.kind),
                      .slope = widened(of.slope),
                      .length = of.length,
                      .handle_frames = of.handle_frames,
                      .handle_value = widened(of.handle_value)};
  };
  const auto outside = [&](const Extrapolation<1>& of) {
    return Extrapolation<3>{.kind = static_cast<Extrapolation<3>::Kind>(of.kind),
                            .slope = widened(of.slope),
                            .count = of.count};
  };
  CurveKeys<3> keys{.keys = {},
                    .before = outside(numbers.before),
                    .after = outside(numbers.after),
                    .overshoot = numbers.overshoot};
  for (const Key<1>& key : numbers.keys)
    keys.keys.push_back({.frame = key.frame,
                         .value = widened(key.value),
                         .next = key.next,
                         .in = tangent(key.in),
                         .out = tangent(key.out),
                         .left = key.left ? std::optional(widened(*key.left)) : std::nullopt});
  return keys;
}

template <int D>
CurveKeys<D> random_keys(Whim& whim, int most) {
  if constexpr (D == 1)
    return whim.keys(most);
  else
    return vector_keys(whim, most);
}

}  // namespace pliant::testing
