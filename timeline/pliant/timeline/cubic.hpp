#pragma once

#include <cmath>
#include <limits>

namespace pliant::timeline {

/// The polynomial c0 + c1 q + c2 q² + c3 q³, where q in [0, 1/2] is counted from the nearer end of
/// a segment: both end values are exact and rounding grows from neither (docs/timeline.md, eq. 4).
struct Cubic {
  double c0 = 0;
  double c1 = 0;
  double c2 = 0;
  double c3 = 0;

  double value(double q) const { return c0 + q * (c1 + q * (c2 + q * c3)); }
  double slope(double q) const { return c1 + q * (2 * c2 + q * (3 * c3)); }
  double half_curvature(double q) const { return c2 + q * (3 * c3); }
};

/// Replaces a slope that overflows, as happens only if its keys are very close, by the largest
/// number of its sign.
inline double within_numbers(double slope) {
  constexpr double most = std::numeric_limits<double>::max();
  return std::fabs(slope) > most ? std::copysign(most, slope) : slope;
}

/// Slope dy/dx of the curve (x(q), y(q)) for growing q: if both first derivatives are 0, the next
/// ones are used (L'Hôpital). Infinite at a vertical tangent, 0 if both x and y are constant.
/// Requires: x does not decrease.
inline double slope_of_curve(const Cubic& x, const Cubic& y, double q) {
  const double x_orders[] = {x.slope(q), x.half_curvature(q), x.c3};
  const double y_orders[] = {y.slope(q), y.half_curvature(q), y.c3};
  for (int order = 0; order < 3; ++order) {
    const double run = x_orders[order];
    const double rise = y_orders[order];
    if (run > 0) return within_numbers(rise / run);
    if (rise != 0) return std::copysign(std::numeric_limits<double>::infinity(), rise);
  }
  return 0;
}

}  // namespace pliant::timeline
