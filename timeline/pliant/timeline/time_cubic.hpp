#pragma once

#include <array>

#include "pliant/timeline/cubic.hpp"
#include "pliant/timeline/exact_sum.hpp"

namespace pliant::timeline {

/// The time of a Bézier segment as a function of its parameter, and the inverse: x(u) = t solved
/// for u (docs/timeline.md, eq. 3 and section "The time solve").
///
/// The unknown is q, the parameter counted from the nearer end, and the equation is in frames from
/// that end, so that a frame next to a key loses no digits.
class TimeCubic {
 public:
  /// A parameter q + correction, in [0, 1/2] but for rounding, from `end` (0: start, 1: end). The
  /// correction is what rounding took from q.
  struct Place {
    int end = 0;
    double q = 0;
    double correction = 0;
  };

  /// The cubic with x(0) = 0, x(1) = length, x'(0) = start_rate, x'(1) = end_rate [frames].
  /// Requires: length > 0; rates >= 0 for which x does not fall (eq. 6).
  TimeCubic(Pair length, Pair start_rate, Pair end_rate);

  /// The place of a frame between `start` and `end`. The residual is below an ulp of the frame;
  /// never leaves its bracket, so never fails. Requires: start <= frame <= end.
  Place place_of(double frame, double start, double end) const;

  /// Frames from one end, over q.
  Cubic from_end(int end) const { return {0, ends_[end].c1.high, ends_[end].c2.high, c3_.high}; }

 private:
  struct End {
    Pair c1;
    Pair c2;
    double chord = 0;  ///< second coefficient of the parabola through q = 0 (with slope) and 1/2
  };

  double residual(const End& end, double q, Pair distance) const;
  Place search(int end, Pair distance) const;

  std::array<End, 2> ends_;
  Pair c3_;
  double middle_ = 0;  ///< x(1/2)
};

}  // namespace pliant::timeline
