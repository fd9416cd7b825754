#include "pliant/timeline/edit/simplify.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pliant/timeline/edit/bake_keys.hpp"
#include "support/catch.hpp"
#include "support/sanitized.hpp"
#include "support/stopping.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

double sampled_deviation(const Curve<1>& a, const Curve<1>& b, double first, double last) {
  double largest = 0;
  for (int i = 0; i <= 5000; ++i) {
    const double t = first + (last - first) * i / 5000;
    largest = std::max(largest, std::fabs(at(a, t) - at(b, t)));
  }
  return largest;
}

CurveKeys<1> baked_sine(int count) {
  CurveKeys<1> keys;
  for (int k = 0; k < count; ++k) {
    const double phase = k * std::numbers::pi / 50;
    keys.keys.push_back(
        key(k, 10 * std::sin(phase), of_slope(std::numbers::pi / 5 * std::cos(phase))));
  }
  return keys;
}

TEST_CASE("a baked sine needs few keys", "[timeline][simplify]") {
  const Curve<1> curve = make(baked_sine(1001));
  std::size_t last_count = 1001;
  double last_error = 0;
  for (const double max_error : {1e-6, 1e-4, 1e-2, 1e-1}) {
    const auto result = simplify(curve, 0, 1000, max_error).value();
    const double sampled = sampled_deviation(make(result.keys), curve, -50, 1050);
    CAPTURE(max_error, result.error, sampled, result.keys.keys.size());
    CHECK(result.error <= max_error);
    CHECK(sampled <= result.error * (1 + 1e-9) + 1e-13);
    CHECK(sampled >= 0.99 * result.error);  // the reported bound is reached
    CHECK(result.keys.keys.size() < last_count);
    last_count = result.keys.keys.size();
    CHECK(result.error > last_error);
    last_error = result.error;
  }
  // Ten periods, a few cubics each.
  CHECK(last_count <= 60);
}

TEST_CASE("the deviation of a simplified curve stays below its bound", "[timeline][simplify]") {
  Whim whim(1);
  int removed = 0;
  for (int round = 0; round < rounds(10000); ++round) {
    CurveKeys<1> keys = whim.keys(12);
    for (Key<1>& each : keys.keys) {
      if (whim.once_in(2)) each.left.reset();
      if (whim.once_in(2)) each.next = {};
    }
    const double first = keys.keys.front().frame;
    const double last = keys.keys.back().frame;
    if (whim.once_in(2) && last > first) {
      keys.keys = bake_keys(make(keys), first, last, (last - first) / 30).value().keys;
    }
    const Curve<1> curve = make(keys);
    const double from = first + whim.between(-0.1, 0.4) * (last - first);
    const double to = first + whim.between(0.6, 1.1) * (last - first);
    const double max_error = whim.size(-3, 1);
    const auto result = simplify(curve, from, to, max_error);
    REQUIRE(result);
    CAPTURE(round, max_error, result->error);
    if (!(result->error <= max_error)) REQUIRE(result->error <= max_error);
    removed += static_cast<int>(keys.keys.size() - result->keys.keys.size());
    const Curve<1> simple = make(result->keys);
    double worst = 0;
    double worst_frame = 0;
    for (int i = 0; i < 20; ++i) {
      const double t = whim.between(first - 10, last + 10);
      const double reach =
          1e-13 * (std::fabs(t) + 10) * (1 + std::fabs(t - first) / (last - first + 1e-3));
      const auto range = curve.range(t - reach, t + reach);
      const double value = at(simple, t);
      const double off = std::max({0.0, range.low[0] - value, value - range.high[0]});
      if (off - 1e-12 * std::fabs(value) > worst) worst_frame = t;
      worst = std::max(worst, off - 1e-12 * std::fabs(value));
    }
    CAPTURE(worst, worst_frame, at(curve, worst_frame), at(simple, worst_frame));
    const double tolerance = result->error * (1 + 1e-9) + 1e-10;
    if (worst > tolerance) REQUIRE(worst <= tolerance);
  }
  CHECK(removed > rounds(20000));
}

TEST_CASE("jumps, steps and easings stay", "[timeline][simplify]") {
  const Interpolation step = of_segment(SegmentKind::Step);
  const Interpolation linear = of_segment(SegmentKind::Linear);
  const Curve<1> curve =
      make({key(0, 0, linear), key(1, 1, linear), key(2, 2, linear), with_left(key(3, 7, step), 3),
            key(4, 7, step), key(5, 9, linear), key(6, 10, linear),
            key(7, 11, of_ease(Ease::Sine, EaseSide::In)), key(8, 3)});
  const auto result = simplify(curve, 0, 8, 1e-9).value();
  std::vector<double> frames;
  for (const Key<1>& each : result.keys.keys) frames.push_back(each.frame);
  CHECK(frames == std::vector<double>{0, 3, 5, 7, 8});
  const Curve<1> simple = make(result.keys);
  for (double t = -1; t < 9; t += 0.125) {
    CAPTURE(t);
    CHECK_THAT(at(simple, t), WithinAbs(at(curve, t), 1e-13));
    CHECK_THAT(simple.left_value(t)[0], WithinAbs(curve.left_value(t)[0], 1e-13));
  }
}

TEST_CASE("only keys in the stretch are removed", "[timeline][simplify]") {
  const CurveKeys<1> keys = baked_sine(101);
  const auto result = simplify(make(keys), 30.5, 59.5, 0.1).value();
  std::size_t untouched = 0;
  for (const Key<1>& each : result.keys.keys) {
    untouched += each.frame < 31 || each.frame > 59 ? 1 : 0;
  }
  CHECK(untouched == 31 + 41);
  CHECK(result.keys.keys.size() < untouched + 10);
}

TEST_CASE("an error of zero leaves the curve alone", "[timeline][simplify]") {
  const CurveKeys<1> keys = baked_sine(101);
  const auto result = simplify(make(keys), 0, 100, 0).value();
  CHECK(result.error == 0);
  CHECK(result.keys == keys);
}

TEST_CASE("vectors are simplified together", "[timeline][simplify]") {
  CurveKeys<3> keys;
  for (int k = 0; k <= 200; ++k) {
    Key<3> each;
    each.frame = k;
    each.value = {std::sin(k / 20.0), 1.0, k / 100.0};
    each.in.kind = each.out.kind = Tangent<3>::Kind::Spline;
    keys.keys.push_back(each);
  }
  const Curve<3> curve = Curve<3>::make(keys).value();
  const auto result = simplify(curve, 0, 200, 1e-3).value();
  const Curve<3> simple = Curve<3>::make(result.keys).value();
  CHECK(result.keys.keys.size() < 40);
  for (double t = 0; t < 200; t += 0.37) {
    for (int c = 0; c < 3; ++c) {
      CAPTURE(t, c);
      CHECK_THAT(simple.value(t)[c], WithinAbs(curve.value(t)[c], result.error + 1e-13));
    }
  }
}

TEST_CASE("simplifying says what it cannot do", "[timeline][simplify]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Curve<1> curve = make(baked_sine(10));
  const auto message = [](const auto& result) {
    REQUIRE(!result);
    return result.error().message;
  };
  CHECK_THAT(message(simplify(curve, nan, 1, 1)), contains_text("first is nan"));
  CHECK_THAT(message(simplify(curve, 0, nan, 1)), contains_text("last is nan"));
  CHECK_THAT(message(simplify(curve, 1, 0, 1)), contains_text("must not come before first"));
  CHECK_THAT(message(simplify(curve, 0, 1, -1)), contains_text("greatest error is -1"));
  CHECK_THAT(message(simplify(curve, 0, 1, nan)), contains_text("greatest error is nan"));
}

TEST_CASE("simplifying many keys can be stopped", "[timeline][simplify][stopping]") {
  const Curve<1> curve = make(baked_sine(20'000));
  check_stops(
      [&](const StopRequest& should_stop) -> Result<void> {
        const auto result = simplify(curve, 0, 20'000, 0.5, should_stop);
        if (result) return {};
        CHECK(result.error().kind == Complaint::Kind::Interrupted);
        return interrupted();
      },
      100);
}

}  // namespace
}  // namespace pliant::testing
