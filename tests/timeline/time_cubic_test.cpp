#include "pliant/timeline/time_cubic.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/catch.hpp"
#include "support/sanitized.hpp"
#include "timeline/authoring.hpp"
#include "timeline/reference_evaluator.hpp"

namespace pliant::testing {
namespace {

using timeline::TimeCubic;

/// x(q + correction) - distance, in long double, for the place of a frame.
long double miss(const TimeCubic::Place& place, double frame, double start, double end,
                 long double start_rate, long double end_rate) {
  const bool is_from_start = place.end == 0;
  const long double length = static_cast<long double>(end) - start;
  const long double near = is_from_start ? start_rate : end_rate;
  const long double far = is_from_start ? end_rate : start_rate;
  const long double q = static_cast<long double>(place.q) + place.correction;
  const long double w = 1 - q;
  const long double x = q * w * (near * w - far * q) + length * q * q * (3 - 2 * q);
  const long double distance = is_from_start ? static_cast<long double>(frame) - start
                                             : static_cast<long double>(end) - frame;
  return x - distance;
}

TEST_CASE("the time solve meets the frame within 3 ulp of it", "[timeline][time_cubic]") {
  Whim whim(11);
  double worst = 0;
  for (int round = 0; round < rounds(10000); ++round) {
    const double start = whim.once_in(3) ? 0 : whim.between(-50, 50);
    const double end = start + whim.size(-3, 3);
    const double span = end - start;
    // Lengths anywhere in the square, often on its edges, or on the ellipse, for which time stops.
    double a = whim.once_in(4) ? static_cast<double>(whim.upto(1)) : whim.between(0, 1);
    double b = whim.once_in(4) ? static_cast<double>(whim.upto(1)) : whim.between(0, 1);
    if (whim.once_in(4)) {
      const double r = whim.size(-3, 3);
      b = (std::sqrt(r) + r + 1) / (r * r + r + 1);
      a = r * b;
    }
    const double start_rate = 3 * a * span;
    const double end_rate = 3 * b * span;
    const TimeCubic time(start, end, {start_rate, 0}, {end_rate, 0});
    for (int i = 0; i < 4; ++i) {
      double frame = start + (whim.once_in(3) ? whim.size(-12, 0) : whim.between(0, 1)) * span;
      if (whim.once_in(4)) frame = end - whim.size(-12, 0) * span;
      frame = std::clamp(frame, start, end);
      const TimeCubic::Place place = time.place_of(frame);
      const double q = place.q + place.correction;
      const auto off =
          static_cast<double>(std::fabs(miss(place, frame, start, end, start_rate, end_rate)));
      // The reference itself rounds at 2^-64 of the segment.
      worst = std::max(worst, off / (ulp(frame) + 0x1p-61 * span));
      if (worst <= 3 && q >= 0 && q <= 0.51) continue;
      CAPTURE(start, end, a, b, frame, place.end, place.q, place.correction, off);
      REQUIRE((q >= 0 && q <= 0.51));
      REQUIRE(worst <= 3);
    }
  }
  CHECK(worst > 0);
}

TEST_CASE("the time solve ends at once where nothing is left to solve", "[timeline][time_cubic]") {
  const TimeCubic time(5, 15, {0, 0}, {0, 0});
  CHECK(time.place_of(5).q == 0);
  CHECK(time.place_of(15).q == 0);
  CHECK(time.place_of(15).end == 1);
  const TimeCubic::Place middle = time.place_of(10);
  CHECK_THAT(middle.q + middle.correction, WithinAbs(0.5, 1e-16));
}

TEST_CASE("frames beside a key keep all their digits", "[timeline][time_cubic]") {
  // x(q) = 3 q² - 2 q³ over ten frames: q = √(d/30) up to terms of higher order.
  const TimeCubic after(0, 10, {0, 0}, {0, 0});
  const TimeCubic before(-10, 0, {0, 0}, {0, 0});
  for (const double distance : {1e-12, 1e-40, 1e-150, 1e-290}) {
    CAPTURE(distance);
    CHECK_THAT(after.place_of(distance).q, WithinRel(std::sqrt(distance / 30), 1e-6));
    CHECK_THAT(before.place_of(-distance).q, WithinRel(std::sqrt(distance / 30), 1e-6));
  }
}

TEST_CASE("the middle of a segment around frame 0 keeps its digits too", "[timeline][time_cubic]") {
  // The curve x(q) - 10 = 20 q² (3 - 2 q) - 10 has the slope 30 at q = 1/2: the place of frame t is
  // t/30 beyond it.
  const TimeCubic time(-10, 10, {0, 0}, {0, 0});
  for (const double frame : {1e-10, 3e-16, 1e-20}) {
    const TimeCubic::Place place = time.place_of(frame);
    CAPTURE(frame, place.q, place.correction);
    const double beyond = (place.end == 0 ? 1 : -1) * ((place.q - 0.5) + place.correction);
    CHECK_THAT(beyond, WithinRel(frame / 30, 1e-9));
  }
}

}  // namespace
}  // namespace pliant::testing
