#include "pliant/timeline/overshoot.hpp"

#include <algorithm>
#include <cmath>

#include "support/catch.hpp"
#include "support/sanitized.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

using timeline::corrected;
using timeline::is_function_of_time;
using timeline::Lengths;

double ellipse(double a, double b) { return a * a + b * b + a * b - 2 * a - 2 * b + 1; }

/// The least x'(u) of a segment of length 1, in closed form.
double least_speed(double a, double b) {
  // x' = 3a w² + 6 (1 - a - b) w u + 3b u²
  const auto speed = [&](double u) {
    const double w = 1 - u;
    return 3 * a * w * w + 6 * (1 - a - b) * w * u + 3 * b * u * u;
  };
  const double curvature = 3 * a + 3 * b - 2;
  double least = std::min(speed(0), speed(1));
  if (curvature != 0) {
    const double u = (2 * a + b - 1) / curvature;
    if (u > 0 && u < 1) least = std::min(least, speed(u));
  }
  return least;
}

TEST_CASE("a segment is legal exactly where time runs forwards", "[timeline][overshoot]") {
  Whim whim(31);
  for (int round = 0; round < rounds(20000); ++round) {
    const double a = whim.between(0, 1.5);
    const double b = whim.between(0, 1.5);
    const double speed = least_speed(a, b);
    if (std::fabs(speed) < 1e-12) continue;
    CAPTURE(a, b, speed);
    REQUIRE(is_function_of_time({a * 8, b * 8}, 8) == (speed > 0));
  }
  CHECK(is_function_of_time({4, 1}, 3));  // the farthest point of the ellipse
  CHECK(is_function_of_time({1, 4}, 3));
  CHECK(is_function_of_time({0.4, 0.1}, 0.3));
  CHECK(!is_function_of_time({1e300, 1e-300}, 1));
}

TEST_CASE("limit moves onto the ellipse and keeps the ratio", "[timeline][overshoot]") {
  Whim whim(32);
  for (int round = 0; round < rounds(20000); ++round) {
    const double span = whim.size(-3, 3);
    const Lengths given{whim.size(-3, 3) * span, whim.once_in(9) ? 0 : whim.size(-3, 3) * span};
    const Lengths legal = corrected(given, span, Overshoot::Limit);
    const double a = legal.start / span;
    const double b = legal.end / span;
    CAPTURE(given.start, given.end, span, a, b);
    if (is_function_of_time(given, span)) {
      REQUIRE(legal.start == given.start);
      REQUIRE(legal.end == given.end);
      continue;
    }
    REQUIRE_THAT(ellipse(a, b), WithinAbs(0, 1e-14));
    REQUIRE_THAT(legal.end * given.start, WithinRel(legal.start * given.end, 1e-14));
    REQUIRE(least_speed(a, b) >= -1e-14);
    REQUIRE(is_function_of_time(legal, span));
  }
  const Lengths alone = corrected({7, 0}, 2, Overshoot::Limit);
  CHECK(alone.start == 2);
  CHECK(alone.end == 0);
}

TEST_CASE("keepStart keeps the start where it can", "[timeline][overshoot]") {
  Whim whim(33);
  for (int round = 0; round < rounds(20000); ++round) {
    const double a = whim.between(0, 2);
    const double b = whim.between(0, 3);
    const Lengths legal = corrected({a, b}, 1, Overshoot::KeepStart);
    CAPTURE(a, b, legal.start, legal.end);
    if (is_function_of_time({a, b}, 1)) {
      REQUIRE((legal.start == a && legal.end == b));
      continue;
    }
    REQUIRE_THAT(ellipse(legal.start, legal.end), WithinAbs(0, 1e-14));
    if (a >= 4.0 / 3) {
      REQUIRE_THAT(legal.start, WithinAbs(4.0 / 3, 1e-15));
      REQUIRE_THAT(legal.end, WithinAbs(1.0 / 3, 1e-15));
      continue;
    }
    REQUIRE(legal.start == a);
    // The other root is not nearer: the sum of both is 2 - a.
    const double other = 2 - a - legal.end;
    REQUIRE(std::fabs(legal.end - b) <= std::fabs(other - b) + 1e-14);
  }
}

TEST_CASE("contain cuts at the segment's length, always", "[timeline][overshoot]") {
  const Lengths bold = corrected({4, 1}, 3, Overshoot::Contain);
  CHECK(bold.start == 3);
  CHECK(bold.end == 1);
  const Lengths both = corrected({9, 8}, 3, Overshoot::Contain);
  CHECK(both.start == 3);
  CHECK(both.end == 3);
}

TEST_CASE("corrections keep slopes and scale vectors", "[timeline][overshoot]") {
  // Contain, so that the expected segment can be written with legal lengths.
  const auto curve_of = [](const Tangent<1>& out, const Tangent<1>& in) {
    CurveKeys<1> keys;
    keys.keys = {key(0, 0), key(4, 3)};
    keys.keys[0].out = out;
    keys.keys[1].in = in;
    keys.overshoot = Overshoot::Contain;
    return make(keys);
  };
  const Curve<1> slopes = curve_of(of_slope(2, 9), of_slope(-1, 5));
  const Curve<1> slopes_legal = curve_of(of_slope(2, 4), of_slope(-1, 4));
  const Curve<1> vectors = curve_of(of_handle(8, 6), of_handle(-16, 8));
  const Curve<1> vectors_legal = curve_of(of_handle(4, 3), of_handle(-4, 2));
  for (double t = 0; t <= 4; t += 0.25) {
    CHECK(at(slopes, t) == at(slopes_legal, t));
    CHECK(at(vectors, t) == at(vectors_legal, t));
  }
}

TEST_CASE("a vector without length that is lengthened keeps its value", "[timeline][overshoot]") {
  // keepStart with a = 1.2 and b = 0 lengthens the in side to the lower root.
  CurveKeys<1> keys;
  keys.keys = {key(0, 0), key(1, 3)};
  keys.keys[0].out = of_slope(0, 1.2);
  keys.keys[1].in = of_handle(0, 0.75);
  keys.overshoot = Overshoot::KeepStart;
  CurveKeys<1> legal = keys;
  const double root = (0.8 - std::sqrt(1.2 * 0.4)) / 2;
  legal.keys[1].in = of_handle(-root, 0.75);
  for (double t = 0; t <= 1; t += 0.125) {
    CHECK_THAT(at(make(keys), t), WithinAbs(at(make(legal), t), 1e-7));  // vertical at t = 8/9
  }
}

}  // namespace
}  // namespace pliant::testing
