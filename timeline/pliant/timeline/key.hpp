#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace pliant {

/// A value of a channel with D components: 1 for a number, 3 for a vector. [unit of the channel]
template <int D>
using Value = std::array<double, D>;

/// The family of an easing; the formulas are in docs/timeline.md.
enum class Ease { Sine, Quad, Cubic, Quart, Quint, Expo, Circ, Back, Bounce, Elastic };

/// At which end of its segment an easing is slow.
enum class EaseSide { In, Out, InOut };

/// The interpolation between a key and the next one.
struct Interpolation {
  enum class Kind {
    Step,      ///< holds this key's value
    StepNext,  ///< has the next key's value just after this key
    Linear,
    Bezier,       ///< shaped by this key's `out` and the next key's `in`
    Easing,       ///< `ease` and `side`
    CubicBezier,  ///< CSS timing function, `control`
  };
  Kind kind = Kind::Bezier;
  Ease ease = Ease::Sine;
  EaseSide side = EaseSide::InOut;
  std::optional<double> amplitude = {};  ///< elastic only [unit]
  std::optional<double> period = {};     ///< elastic only [frames]
  std::optional<double> back = {};       ///< back only: overshoot q [1], 1.70158 when absent
  std::array<double, 4> control = {0, 0, 1, 1};  ///< cubicBezier only: x1 y1 x2 y2 [1], x in [0,1]

  friend bool operator==(const Interpolation&, const Interpolation&) = default;
};

/// The tangent on one side of a key.
template <int D>
struct Tangent {
  enum class Kind { Auto, Spline, Linear, Flat, Clamped, Plateau, Smooth, Free, Slope, Handle };
  Kind kind = Kind::Auto;
  Value<D> slope = {};                ///< read by Slope [unit/frame]
  std::optional<double> length = {};  ///< how far the tangent extends [frames]; negative counts as
                                      ///< 0; absent: a third of the segment, which makes a cubic in
                                      ///< time. Not read by Handle.
  double handle_frames = 0;           ///< read by Handle, relative to the key: <= 0 for `in`, >= 0
                                      ///< for `out`; ignored if it points the other way
  Value<D> handle_value = {};         ///< read by Handle, relative to the key [unit]

  friend bool operator==(const Tangent&, const Tangent&) = default;
};

/// One key of a curve.
template <int D>
struct Key {
  double frame = 0;
  Value<D> value = {};
  Interpolation next = {};  ///< the segment that starts here
  Tangent<D> in = {};
  Tangent<D> out = {};
  std::optional<Value<D>> left = {};  ///< the limit from the left if the curve jumps at this key

  friend bool operator==(const Key&, const Key&) = default;
};

/// How to correct Bézier tangents that would make time run backwards; the rules are in
/// docs/timeline.md.
enum class Overshoot { Limit, KeepStart, Contain, Error };

/// The behaviour of a curve on one side of its keys.
template <int D>
struct Extrapolation {
  enum class Kind { Hold, Linear, LinearOuter, Slope, Repeat, RepeatOffset, Mirror };
  Kind kind = Kind::Hold;
  Value<D> slope = {};               ///< read by Slope [unit/frame]
  std::optional<double> count = {};  ///< copies of a loop, an integer >= 1; absent: endless

  friend bool operator==(const Extrapolation&, const Extrapolation&) = default;
};

/// An inner loop: the keys in [from, to) are repeated `before` times before `from` and `after`
/// times after `to`, copy n moved by n times `offset`.
template <int D>
struct Loop {
  double from = 0;  ///< the frame of a key
  double to = 0;    ///< > from
  int before = 0;
  int after = 0;
  Value<D> offset = {};

  friend bool operator==(const Loop&, const Loop&) = default;
};

/// The complete description of a curve by its author.
template <int D>
struct CurveKeys {
  std::vector<Key<D>> keys;  ///< at least one, frames strictly increasing
  Extrapolation<D> before = {};
  Extrapolation<D> after = {};
  std::optional<Loop<D>> loop = {};
  Overshoot overshoot = Overshoot::Limit;

  friend bool operator==(const CurveKeys&, const CurveKeys&) = default;
};

}  // namespace pliant
