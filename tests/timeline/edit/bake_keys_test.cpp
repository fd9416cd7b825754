#include "pliant/timeline/edit/bake_keys.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/catch.hpp"
#include "support/sanitized.hpp"
#include "support/stopping.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

double largest_deviation(const Curve<1>& a, const Curve<1>& b, double first, double last) {
  double largest = 0;
  for (int i = 0; i <= 4000; ++i) {
    const double t = first + (last - first) * i / 4000;
    largest = std::max(largest, std::fabs(at(a, t) - at(b, t)));
  }
  return largest;
}

TEST_CASE("baked keys have the curve's values and limits", "[timeline][bake]") {
  Whim whim(1);
  for (int round = 0; round < rounds(3000); ++round) {
    CurveKeys<1> keys = whim.keys(6);
    for (Key<1>& each : keys.keys) each.frame = std::round(each.frame);
    for (std::size_t k = 1; k < keys.keys.size(); ++k) {
      keys.keys[k].frame = std::max(keys.keys[k].frame, keys.keys[k - 1].frame + 1);
    }
    const Curve<1> curve = make(keys);
    const auto baked = bake_keys(curve, -30, 40, 1);
    REQUIRE(baked);
    REQUIRE(baked->keys.size() == 71);
    const Curve<1> result = make(*baked);
    bool agrees = true;
    for (double t = -30; t <= 40; ++t) {
      agrees = agrees && at(result, t) == at(curve, t);
      agrees = agrees && (t == -30 || result.left_value(t) == curve.left_value(t));
    }
    CAPTURE(round);
    if (!agrees) REQUIRE(agrees);
  }
}

TEST_CASE("a smooth curve is baked to fourth order", "[timeline][bake]") {
  // A sine, an exponential and a fifth power.
  for (const Ease ease : {Ease::Sine, Ease::Expo, Ease::Quint}) {
    const Curve<1> curve = make({key(0, 0, of_ease(ease, EaseSide::In)), key(16, 10)});
    const auto error = [&](double step) {
      return largest_deviation(make(bake_keys(curve, 0, 16, step).value()), curve, 0, 16);
    };
    CAPTURE(static_cast<int>(ease), error(0.5), error(0.25), error(0.125));
    CHECK(std::log2(error(0.5) / error(0.25)) > 3.8);
    CHECK(std::log2(error(0.25) / error(0.125)) > 3.8);
  }
}

TEST_CASE("straight baked keys are met to second order", "[timeline][bake]") {
  const Curve<1> curve = make({key(0, 0, of_ease(Ease::Sine, EaseSide::In)), key(16, 10)});
  const auto error = [&](double step) {
    const auto baked = bake_keys(curve, 0, 16, step, SegmentKind::Linear);
    return largest_deviation(make(*baked), curve, 0, 16);
  };
  CHECK_THAT(std::log2(error(0.5) / error(0.25)), WithinAbs(2, 0.1));
}

TEST_CASE("steps are baked as they are", "[timeline][bake]") {
  const Curve<1> curve =
      make({key(0, 1, of_segment(SegmentKind::Step)), key(4, 5, of_segment(SegmentKind::StepNext)),
            key(8, -2), key(12, 3)});
  for (const double step : {1.0, 2.0, 4.0}) {
    const Curve<1> baked = make(bake_keys(curve, 0, 8, step).value());
    for (double t = 0; t <= 8; t += 0.125) {
      CAPTURE(step, t);
      CHECK(at(baked, t) == at(curve, t));
    }
  }
}

TEST_CASE("the last frame gets a key, and loops are written out", "[timeline][bake]") {
  CurveKeys<1> keys{{key(0, 0), key(3, 4)}};
  keys.after.kind = OutsideKind::Mirror;
  const Curve<1> curve = make(keys);
  const auto baked = bake_keys(curve, 0, 10, 4).value();
  REQUIRE(baked.keys.size() == 4);
  CHECK(baked.keys[2].frame == 8);
  CHECK(baked.keys[3].frame == 10);
  CHECK(baked.keys[3].value == curve.value(10));
  CHECK(bake_keys(curve, 0, 0.3, 0.1)->keys.size() == 4);
  CHECK(bake_keys(curve, 2, 2, 1)->keys.size() == 1);
}

TEST_CASE("an infinite slope is baked as a straight line's", "[timeline][bake]") {
  const Curve<1> curve = make({key(0, 0, of_ease(Ease::Circ, EaseSide::In)), key(8, 8)});
  const auto baked = bake_keys(curve, 0, 8, 2).value();
  CHECK(baked.keys[4].in.slope[0] == (at(curve, 8) - at(curve, 6)) / 2);
}

TEST_CASE("baking says what it cannot do", "[timeline][bake]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Curve<1> curve = make({key(0, 0), key(3, 4)});
  const auto message = [](const auto& result) {
    REQUIRE(!result);
    return result.error().message;
  };
  CHECK_THAT(message(bake_keys(curve, nan, 1, 1)), contains_text("first is nan"));
  CHECK_THAT(message(bake_keys(curve, 0, nan, 1)), contains_text("last is nan"));
  CHECK_THAT(message(bake_keys(curve, 0, 1, nan)), contains_text("step is nan"));
  CHECK_THAT(message(bake_keys(curve, 0, 1, 0)), contains_text("must be positive"));
  CHECK_THAT(message(bake_keys(curve, 1, 0, 1)), contains_text("must not come before first"));
  CHECK_THAT(message(bake_keys(curve, 0, 1e7, 1)), contains_text("more than 1e+06 keys"));
  CHECK_THAT(message(bake_keys(curve, 1e16, 1e16 + 8, 0.5)), contains_text("strictly increase"));
  CHECK_THAT(message(bake_keys(curve, 0, 1, 1, SegmentKind::Step)),
             contains_text("linear or bezier"));
}

TEST_CASE("baking of many keys can be stopped", "[timeline][bake][stopping]") {
  const Curve<1> curve = make({key(0, 0), key(500, 4), key(1000, 1)});
  check_stops(
      [&](const StopRequest& should_stop) -> Result<void> {
        const auto baked =
            bake_keys(curve, 0, 1000, 0.05, Interpolation::Kind::Bezier, should_stop);
        if (baked) return {};
        CHECK(baked.error().kind == Complaint::Kind::Interrupted);
        return interrupted();
      },
      200);
}

}  // namespace
}  // namespace pliant::testing
