#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/timeline/curve.hpp"
#include "support/catch.hpp"
#include "support/sanitized.hpp"
#include "timeline/authoring.hpp"
#include "timeline/reference_evaluator.hpp"

namespace pliant::testing {
namespace {

/// Two keys with tangents of any legal lengths: in the square, on its edges, on the ellipse (for
/// which time stops somewhere inside), or thirds.
std::vector<Key<1>> random_segment(Whim& whim) {
  double a = whim.between(0, 1);
  double b = whim.between(0, 1);
  if (whim.once_in(5)) a = whim.upto(1);
  if (whim.once_in(5)) b = whim.upto(1);
  if (whim.once_in(8)) a = whim.size(-9, 0);
  if (whim.once_in(8)) {
    const double r = whim.size(-3, 3);
    b = (std::sqrt(r) + r + 1) / (r * r + r + 1) * (1 - 1e-12);
    a = r * b;
  }
  const double start = whim.once_in(3) ? 0 : whim.between(-100, 100);
  const double end = start + whim.size(-1, 2);
  std::vector<Key<1>> keys = {key(start, whim.between(-10, 10)), key(end, whim.between(-10, 10))};
  const double span = end - start;
  keys[0].out = of_slope(whim.between(-20, 20) / span, a * span);
  keys[1].in = of_slope(whim.between(-20, 20) / span, b * span);
  if (whim.once_in(8)) keys[0].out.length = keys[1].in.length = {};
  return keys;
}

TEST_CASE("a value is that of the exact curve at a time within 4 ulp", "[timeline][curve]") {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Whim whim(21);
  double worst_where_level = 0;
  int level = 0;
  for (int round = 0; round < rounds(100000); ++round) {
    const std::vector<Key<1>> keys = random_segment(whim);
    const Curve<1> curve = make(keys);
    const ReferenceSegment exact = reference_segments(keys).front();
    const double start = keys[0].frame;
    const double end = keys[1].frame;
    double frame = whim.between(start, end);
    if (whim.once_in(6)) frame = start + whim.size(-9, 0) * (end - start);
    if (whim.once_in(6)) frame = end - whim.size(-9, 0) * (end - start);
    frame = std::clamp(frame, start, end);

    double early = frame;
    double late = frame;
    for (int i = 0; i < 4; ++i) {
      early = std::nextafter(early, -infinity);
      late = std::nextafter(late, infinity);
    }
    const double value = at(curve, frame);
    const long double before = exact.value(std::max(early, start));
    const long double here = exact.value(frame);
    const long double after = exact.value(std::min(late, end));
    // The value itself has about ten roundings, each at most 2^-53 of the largest control value.
    double size = 0;
    for (const long double each : exact.v) {
      size = std::max(size, std::fabs(static_cast<double>(each)));
    }
    const double rounding = 12 * 0x1p-53 * size;
    const bool is_within = value >= std::min({before, here, after}) - rounding &&
                           value <= std::max({before, here, after}) + rounding;
    const double off = std::fabs(static_cast<double>(value - here));
    const ValueRange<1> range = curve.range(start, end);
    const double height = range.high[0] - range.low[0];
    const double steepness = std::fabs(curve.velocity(frame)[0]) * (end - start);
    const bool is_level = steepness <= 1e3 * height;
    if (is_level) {
      ++level;
      // A curve whose range is smaller than its values has their rounding errors too.
      worst_where_level = std::max(worst_where_level, (off - rounding) / height);
    }
    if (is_within && worst_where_level <= 1e-12) continue;
    CAPTURE(round, start, end, frame, value, static_cast<double>(here), off, rounding, height);
    REQUIRE(is_within);
    REQUIRE(worst_where_level <= 1e-12);
  }
  CHECK(level > rounds(90000));
}

}  // namespace
}  // namespace pliant::testing
