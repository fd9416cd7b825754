#include "pliant/timeline/overshoot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant::timeline {

namespace {

// Lengths are computed from products and differences of frames: a few roundings.
constexpr double tolerance = 4 * std::numeric_limits<double>::epsilon();

/// Eq. 6a: the point of the ellipse with the same ratio, for smaller <= larger. Source: OpenUSD's
/// keep-ratio.
Lengths on_ellipse(double start, double end, double span) {
  if (end == 0) return {span, 0};
  // The formula with the ratio that is at most 1: it is symmetric and cannot overflow then.
  const double ratio = std::min(start, end) / std::max(start, end);
  const double larger = (std::sqrt(ratio) + ratio + 1) / (ratio * ratio + ratio + 1) * span;
  const double smaller = ratio * larger;
  if (start <= end) return {smaller, larger};
  return {larger, smaller};
}

/// Eq. 6b: keeps the start length and moves the end length to the ellipse. Source: Maya.
Lengths keep_start(double start, double end, double span) {
  const double a = start / span;
  if (3 * start >= 4 * span) return {4 * span / 3, span / 3};
  const double centre = 2 - a;
  const double radius = std::sqrt(a * (4 - 3 * a));  // (a-2)² - 4(a-1)² without cancellation
  const double low = (centre - radius) / 2 * span;
  const double high = (centre + radius) / 2 * span;
  return {start, std::fabs(end - low) < std::fabs(end - high) ? low : high};
}

}  // namespace

bool is_function_of_time(Lengths lengths, double span) {
  const double limit = span * (1 + tolerance);
  if (lengths.start <= limit && lengths.end <= limit) return true;
  if (lengths.start > 1.5 * span || lengths.end > 1.5 * span)
    return false;  // prevents overflow below
  const double a = lengths.start;
  const double b = lengths.end;
  const double conic = a * a + b * b + a * b - 2 * span * (a + b) + span * span;
  return conic <= 4 * tolerance * span * span;
}

Lengths corrected(Lengths lengths, double span, Overshoot policy) {
  if (policy == Overshoot::Contain) {
    return {std::min(lengths.start, span), std::min(lengths.end, span)};
  }
  if (policy == Overshoot::Error || is_function_of_time(lengths, span)) return lengths;
  if (policy == Overshoot::KeepStart) return keep_start(lengths.start, lengths.end, span);
  return on_ellipse(lengths.start, lengths.end, span);
}

}  // namespace pliant::timeline
