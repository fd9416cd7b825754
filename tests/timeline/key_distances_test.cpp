// Keys at any distance that two numbers can have: the values of a curve between and beside them are
// finite numbers.

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "pliant/timeline/curve.hpp"
#include "pliant/timeline/sampler.hpp"
#include "support/catch.hpp"
#include "support/sanitized.hpp"
#include "timeline/authoring.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

constexpr double least = std::numeric_limits<double>::denorm_min();
constexpr double most = std::numeric_limits<double>::max();

struct Way {
  std::string name;
  Interpolation next;
  Tangent<1> out = {};
  Tangent<1> in = {};
  bool is_upright = false;  // its slope is infinite somewhere, not by overflow
};

std::vector<Way> easings() {
  std::vector<Way> ways;
  for (const Ease ease : {Ease::Sine, Ease::Quad, Ease::Cubic, Ease::Quart, Ease::Quint, Ease::Expo,
                          Ease::Circ, Ease::Back, Ease::Bounce, Ease::Elastic}) {
    for (const EaseSide side : {EaseSide::In, EaseSide::Out, EaseSide::InOut}) {
      const std::string name =
          "ease " + std::to_string(static_cast<int>(ease)) + std::to_string(static_cast<int>(side));
      Way way{name, of_ease(ease, side)};
      way.is_upright = ease == Ease::Circ;
      ways.push_back(way);
      if (ease == Ease::Back) {
        for (const double back : {0.0, -1e150, 1e150}) {
          ways.push_back(way);
          ways.back().next.back = back;
        }
      }
      if (ease != Ease::Elastic) continue;
      for (const double amplitude : {0.0, 1e-300, 0.5, 3.0, 1e150}) {
        for (const double period : {0.0, least, 1e-308, 1e-150, -0.3, 5.0, 1e150}) {
          ways.push_back(way);
          ways.back().name += fmt::format(" {} {}", amplitude, period);
          ways.back().next.amplitude = amplitude;
          ways.back().next.period = period;
        }
      }
    }
  }
  return ways;
}

std::vector<Way> beziers(double length) {
  std::vector<Way> ways;
  for (int kind = 0; kind < static_cast<int>(TangentKind::Slope); ++kind) {
    const Tangent<1> tangent = of_kind(static_cast<TangentKind>(kind));
    ways.push_back({"tangent " + std::to_string(kind), {}, tangent, tangent});
  }
  for (const double share : {0.0, 0.1, 0.5, 1.0, 1.3, 2.0}) {
    for (const double slope : {0.0, 1.0, -1e100}) {
      const Tangent<1> numeric = of_slope(slope, share * length);
      ways.push_back({fmt::format("slope {} {}", slope, share), {}, numeric, numeric});
    }
    const Way handles{fmt::format("handle {}", share),
                      {},
                      of_handle(share * length, 0.5),
                      of_handle(-(share / 3) * length, 2)};
    // Handles of no length, and those that `limit` makes legal, may be vertical.
    ways.push_back(handles);
    ways.back().is_upright = true;
  }
  for (const auto& control :
       {std::array{0.25, 0.1, 0.25, 1.0}, std::array{0.0, 0.0, 1.0, 1.0},
        std::array{0.0, 1.0, 0.0, 1.0}, std::array{1.0, 0.0, 0.0, 1.0},
        std::array{1.0 / 3, 1e150, 2.0 / 3, -1e150}, std::array{0.4, 7.0, 0.9, -7.0}}) {
    Way way{"cubicBezier", of_segment(SegmentKind::CubicBezier)};
    way.next.control = control;
    way.is_upright = control[0] == 0 || control[2] == 1;
    ways.push_back(way);
  }
  return ways;
}

std::vector<Way> all_ways(double length) {
  std::vector<Way> ways = easings();
  for (const SegmentKind kind : {SegmentKind::Step, SegmentKind::StepNext, SegmentKind::Linear}) {
    ways.push_back({"kind " + std::to_string(static_cast<int>(kind)), of_segment(kind)});
  }
  for (Way& way : beziers(length)) ways.push_back(std::move(way));
  return ways;
}

// The keys, the frames next to them, and a few frames between.
std::vector<double> frames_of(double start, double end) {
  std::vector<double> frames = {start,
                                end,
                                std::nextafter(start, end),
                                std::nextafter(end, start),
                                std::nextafter(start, -most),
                                std::nextafter(end, most)};
  for (const double share : {0.01, 0.25, 0.5, 0.7, 0.999}) {
    frames.push_back(start + share * (end - start));
  }
  return frames;
}

void check_finite(const Curve<1>& curve, double frame, bool is_upright) {
  Sampler<1> sampler(curve);
  CAPTURE(frame);
  for (const double value : {curve.value(frame)[0], curve.left_value(frame)[0],
                             sampler.value(frame)[0], sampler.left_value(frame)[0]}) {
    REQUIRE(std::isfinite(value));
  }
  for (const double velocity : {curve.velocity(frame)[0], curve.left_velocity(frame)[0],
                                sampler.velocity(frame)[0], sampler.left_velocity(frame)[0]}) {
    REQUIRE_FALSE(std::isnan(velocity));
    if (!is_upright) REQUIRE(std::isfinite(velocity));
  }
}

// Whether there is such a curve; an error is also correct.
bool check_curve(const Way& way, double start, double length, double change) {
  CurveKeys<1> keys;
  keys.keys = {key(start, 0, way.next), key(start + length, change)};
  keys.keys[0].out = way.out;
  keys.keys[1].in = way.in;
  keys.before.kind = keys.after.kind = OutsideKind::Linear;
  const auto curve = Curve<1>::make(keys);
  if (!curve) {
    CHECK(curve.error().message.find("nan") == std::string::npos);
    return false;
  }
  for (const double frame : frames_of(start, start + length)) {
    // Outside the keys a slope may make a value overflow.
    if (frame >= start && frame <= start + length) check_finite(*curve, frame, way.is_upright);
  }
  return true;
}

}  // namespace

TEST_CASE("keys at any distance give finite values and velocities", "[timeline][curve]") {
  for (const double length : {least, 2 * least, 3 * least, 100 * least, 1e-310, 0x1p-1022, 1e-300,
                              0x1p-900, 1e-270, 1e-160, 1e-100, 1e-30, 1.0, 1e30, 1e100, 1e150}) {
    if (is_sanitized && length != least) continue;
    int made = 0;
    for (const Way& way : all_ways(length)) {
      for (const double start : {0.0, -length, length / 2}) {
        for (const double change : {0.0, least, 1e-150, 1.0, -3.0, 1e150}) {
          CAPTURE(length, way.name, start, change);
          made += check_curve(way, start, length, change) ? 1 : 0;
        }
      }
    }
    CAPTURE(length);
    CHECK(made > 1000);
  }
}

TEST_CASE("easings are the same at every length of their segment", "[timeline][easing]") {
  // Sixteen of the least positive frames, compared with sixteen whole frames; nothing is rounded.
  for (const Way& way : easings()) {
    if (way.next.period.value_or(0) != 0) continue;
    const Curve<1> tiny = make({key(0, 1, way.next), key(16 * least, 4)});
    const Curve<1> usual = make({key(0, 1, way.next), key(16, 4)});
    for (int frame = 0; frame <= 16; ++frame) {
      CAPTURE(way.name, frame);
      CHECK(at(tiny, frame * least) == at(usual, frame));
    }
  }
}

TEST_CASE("a velocity beyond all numbers is the largest of them", "[timeline][curve]") {
  const Curve<1> rising = make({key(0, 0, of_segment(SegmentKind::Linear)), key(least, 1)});
  CHECK(rising.velocity(0)[0] == most);
  CHECK(rising.left_velocity(least)[0] == most);
  const Curve<1> falling =
      make({key(0, 1, of_ease(Ease::Elastic, EaseSide::InOut)), key(least, 0)});
  CHECK(std::isfinite(falling.velocity(0)[0]));
  CHECK(falling.value(0)[0] == 1);
  CHECK(falling.value(least)[0] == 0);
  // The slope cannot be continued outside the keys: as if it were infinite.
  CurveKeys<1> keys;
  keys.keys = {key(0, 0, of_segment(SegmentKind::Linear)), key(least, 1)};
  keys.after.kind = OutsideKind::Linear;
  CHECK(make(keys).value(10)[0] == 1);
}

TEST_CASE("an elastic far larger than its change keeps a finite velocity", "[timeline][easing]") {
  Interpolation elastic = of_ease(Ease::Elastic, EaseSide::In);
  elastic.amplitude = 1e150;
  elastic.period = 1e-14;
  const Curve<1> curve = make({key(0, 0, elastic), key(1, 1e-149)});
  double largest = 0;
  for (int k = 1; k < 1000; ++k) {
    largest = std::fmax(largest, std::fabs(curve.velocity(k / 1000.0)[0]));
  }
  CHECK(largest > 1e160);  // 1e150 * 2 pi / 1e-14 where the wave crosses 0 at the end
  CHECK(largest < 1e166);
}
