#include "pliant/timeline/extrapolated.hpp"

#include <algorithm>
#include <cmath>

#include "support/catch.hpp"
#include "support/sanitized.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

/// Keys at dyadic frames, so that copies can be written without rounding.
CurveKeys<1> cycle() {
  CurveKeys<1> keys;
  keys.keys = {key(1, 2, of_slope(1)), key(2.5, 5, of_slope(-1)),
               key(4, 3, of_segment(SegmentKind::StepNext)), with_left(key(6, 4), 7),
               with_left(key(9, 8), 6)};
  return keys;
}

/// The same keys followed by `copies` copies of the cycle, written out as keys.
CurveKeys<1> written_out(const CurveKeys<1>& keys, int copies, double offset) {
  CurveKeys<1> written = keys;
  const double span = keys.keys.back().frame - keys.keys.front().frame;
  for (int n = 1; n <= copies; ++n) {
    // At the joint the earlier copy's last key stays; the segment after it starts like the first
    // key's.
    Key<1>& joint = written.keys.back();
    const Key<1>& first = keys.keys.front();
    joint.next = first.next;
    joint.out = first.out;
    for (std::size_t k = 1; k < keys.keys.size(); ++k) {
      Key<1> copy = keys.keys[k];
      copy.frame += n * span;
      copy.value[0] += n * offset;
      if (copy.left) (*copy.left)[0] += n * offset;
      written.keys.push_back(copy);
    }
  }
  return written;
}

TEST_CASE("repeatOffset equals the curve with the copies written out", "[timeline][extrapolated]") {
  CurveKeys<1> keys = cycle();
  keys.after.kind = OutsideKind::RepeatOffset;
  keys.before.kind = OutsideKind::RepeatOffset;
  keys.after.count = 3;
  const Curve<1> curve = make(keys);
  const CurveKeys<1> written = written_out(cycle(), 3, 6);
  const Curve<1> reference = make(written);
  for (double t = 1; t < 40; t += 0.0625) {
    CAPTURE(t);
    REQUIRE_THAT(at(curve, t), WithinAbs(at(reference, t), 1e-13));
    REQUIRE_THAT(curve.velocity(t)[0], WithinAbs(reference.velocity(t)[0], 1e-13));
    if (t == 1) continue;  // left of the first key this curve repeats, the reference is constant
    REQUIRE_THAT(curve.left_value(t)[0], WithinAbs(reference.left_value(t)[0], 1e-13));
    REQUIRE_THAT(curve.left_velocity(t)[0], WithinAbs(reference.left_velocity(t)[0], 1e-13));
  }
  // Before the keys every copy is lower by the offset.
  for (double t = -40; t < 1; t += 0.0625) {
    CAPTURE(t);
    const double copies = std::ceil((1 - t) / 8);
    if (std::fmod(1 - t, 8) == 0) continue;
    REQUIRE_THAT(at(curve, t), WithinAbs(at(curve, t + 8 * copies) - 6 * copies, 1e-12));
  }
}

TEST_CASE("mirror returns on its own way", "[timeline][extrapolated]") {
  CurveKeys<1> keys = cycle();
  keys.after.kind = OutsideKind::Mirror;
  keys.before.kind = OutsideKind::Mirror;
  const Curve<1> curve = make(keys);
  for (double d = 0.0625; d < 8; d += 0.0625) {
    CAPTURE(d);
    REQUIRE(at(curve, 9 + d) == at(curve, 9 - d));
    REQUIRE(at(curve, 1 - d) == at(curve, 1 + d));
    REQUIRE(at(curve, 17 + d) == at(curve, 1 + d));
    REQUIRE(at(curve, -7 - d) == at(curve, 9 - d));
    REQUIRE(curve.velocity(9 + d)[0] == 0 - curve.left_velocity(9 - d)[0]);
    REQUIRE(curve.left_velocity(9 + d)[0] == 0 - curve.velocity(9 - d)[0]);
  }
  // When a stepNext runs backwards, its jump is on the other side.
  CHECK(at(curve, 14) == 3);
  CHECK(curve.left_value(14)[0] == 7);
  // A copy that ends with a jump at a joint is followed by a mirrored copy with the reverse jump.
  CHECK(at(curve, 9) == 8);
  CHECK(curve.left_value(9)[0] == 6);
  CHECK(curve.left_value(17)[0] == 2);
}

TEST_CASE("joints belong to the copy nearer to the keys", "[timeline][extrapolated]") {
  CurveKeys<1> keys = {.keys = {key(0, 1, of_segment(SegmentKind::Linear)), key(2, 5)}};
  keys.before.kind = keys.after.kind = OutsideKind::Repeat;
  const Curve<1> curve = make(keys);
  for (const double n : {0.0, 1.0, 2.0, 1e9, 1e15}) {
    CAPTURE(n);
    CHECK(at(curve, 2 + 2 * n) == 5);
    CHECK(curve.left_value(2 + 2 * n)[0] == 5);
    CHECK(at(curve, -2 * n) == 1);
    CHECK(curve.left_value(-2 * n)[0] == 5);
    CHECK(curve.velocity(2 + 2 * n)[0] == 2);
    CHECK(curve.left_velocity(-2 * n)[0] == 2);
  }
}

TEST_CASE("far frames are as exact as near ones", "[timeline][extrapolated]") {
  for (const auto kind : {OutsideKind::Repeat, OutsideKind::RepeatOffset, OutsideKind::Mirror}) {
    CurveKeys<1> keys = cycle();
    keys.before.kind = keys.after.kind = kind;
    const Curve<1> curve = make(keys);
    const double offset = kind == OutsideKind::RepeatOffset ? 6 : 0;
    for (const double cycles : {1e3, 1e6, 1e9, 1e12}) {
      for (double t = 1.0625; t < 9; t += 0.125) {
        CAPTURE(static_cast<int>(kind), cycles, t);
        REQUIRE(at(curve, t + 8 * cycles) == at(curve, t) + cycles * offset);
        REQUIRE(at(curve, t - 8 * cycles) == at(curve, t) - cycles * offset);
      }
    }
    CHECK(std::isfinite(at(curve, 1e300)));
    CHECK(std::isfinite(at(curve, -1e300)));
  }
}

TEST_CASE("after the last copy its end value holds", "[timeline][extrapolated]") {
  const auto held = [](OutsideKind kind, double count, double frame) {
    CurveKeys<1> keys = {.keys = {key(0, 1), key(2, 5)}};
    keys.before = keys.after = {.kind = kind, .count = count};
    const Curve<1> curve = make(keys);
    CHECK(curve.velocity(frame)[0] == 0);
    CHECK(curve.left_velocity(frame)[0] == 0);
    CHECK(curve.left_value(frame) == curve.value(frame));
    return at(curve, frame);
  };
  CHECK(held(OutsideKind::Repeat, 2, 1e6) == 5);
  CHECK(held(OutsideKind::Repeat, 2, -1e6) == 1);
  CHECK(held(OutsideKind::RepeatOffset, 2, 1e6) == 13);
  CHECK(held(OutsideKind::RepeatOffset, 2, -1e6) == -7);
  CHECK(held(OutsideKind::Mirror, 1, 1e6) == 1);
  CHECK(held(OutsideKind::Mirror, 1, -1e6) == 5);
  CHECK(held(OutsideKind::Mirror, 2, 1e6) == 5);
  CHECK(held(OutsideKind::Mirror, 2, -1e6) == 1);
}

TEST_CASE("lines continue the curve or its tangent", "[timeline][extrapolated]") {
  CurveKeys<1> keys = {.keys = {key(0, 1, of_slope(2)), key(3, 4, of_slope(-1))}};
  keys.keys[0].in = of_slope(7, 0);
  keys.keys[1].out = of_handle(2, 3);
  keys.before.kind = keys.after.kind = OutsideKind::Linear;
  CHECK_THAT(at(make(keys), -2), WithinAbs(1 - 2 * 2, 1e-14));
  CHECK_THAT(at(make(keys), 5), WithinAbs(4 - 2 * 1, 1e-14));
  keys.before.kind = keys.after.kind = OutsideKind::LinearOuter;
  CHECK(at(make(keys), -2) == 1 - 2 * 7);
  CHECK(at(make(keys), 5) == 4 + 2 * 1.5);
  keys.keys[1].out = of_handle(0, 3);
  CHECK(at(make(keys), 5) == 4);
  keys.keys[1].out = of_handle(-2, 3);
  CHECK(at(make(keys), 5) == 4);
  keys.before = keys.after = {.kind = OutsideKind::Slope, .slope = {0.5}};
  CHECK(at(make(keys), -2) == 0);
  CHECK(at(make(keys), 5) == 5);
}

TEST_CASE("the line is level where the curve has no slope to continue",
          "[timeline][extrapolated]") {
  CurveKeys<1> keys = {.keys = {key(0, 1), key(3, 4)}};
  keys.before.kind = keys.after.kind = OutsideKind::Linear;
  for (const auto kind : {SegmentKind::Step, SegmentKind::StepNext}) {
    keys.keys[0].next.kind = kind;
    CHECK(at(make(keys), -5) == 1);
    CHECK(at(make(keys), 9) == 4);
  }
  keys.keys[0].next.kind = SegmentKind::Linear;
  CHECK(at(make(keys), 5) == 6);
  keys.keys[1].left = Value<1>{2};  // a jump at the end
  CHECK(at(make(keys), 5) == 4);
  keys.keys[1].left = std::nullopt;
  keys.keys[0].next.kind = SegmentKind::Bezier;
  keys.keys[1].in = of_handle(0, -2);  // a vertical tangent
  CHECK(at(make(keys), 5) == 4);
}

TEST_CASE("before the first key the curve comes from its left value", "[timeline][extrapolated]") {
  CurveKeys<1> keys = {.keys = {with_left(key(0, 1, of_slope(3)), -4), key(3, 4)}};
  const auto before = [&](OutsideKind kind) {
    keys.before = {.kind = kind, .slope = {2}};
    const Curve<1> curve = make(keys);
    CHECK(at(curve, 0) == 1);
    CHECK(curve.left_value(0)[0] == -4);
    return at(curve, -1);
  };
  CHECK(before(OutsideKind::Hold) == -4);
  CHECK(before(OutsideKind::Linear) == -4);
  CHECK(before(OutsideKind::LinearOuter) == -7);
  CHECK(before(OutsideKind::Slope) == -6);
}

TEST_CASE("the range of a curve holds all its values and no more", "[timeline][extrapolated]") {
  Whim whim(61);
  for (int round = 0; round < rounds(1500); ++round) {
    const CurveKeys<1> keys = whim.keys(4);
    const Curve<1> curve = make(keys);
    const double length = 2 + keys.keys.back().frame - keys.keys.front().frame;
    const double from = keys.keys.front().frame - whim.between(-1, 4) * length;
    const double to = from + whim.between(0, 6) * length;
    const ValueRange<1> range = curve.range(from, to);
    double low = std::min(at(curve, from), at(curve, to));
    double high = std::max(at(curve, from), at(curve, to));
    constexpr int parts = 400;
    for (int i = 0; i <= parts; ++i) {
      const double t = std::min(to, from + (to - from) * i / parts);
      low = std::min(low, at(curve, t));
      high = std::max(high, at(curve, t));
    }
    const double size = 1 + std::max(std::fabs(low), std::fabs(high));
    CAPTURE(round, from, to, low, high, range.low[0], range.high[0]);
    REQUIRE(range.low[0] <= low + 1e-13 * size);
    REQUIRE(range.high[0] >= high - 1e-13 * size);
    REQUIRE(curve.range(to, from) == range);
  }
}

TEST_CASE("the range is tight", "[timeline][extrapolated]") {
  // A parabola-like hill: from slope 4 to slope -4 over one frame, top 1 in the middle.
  CurveKeys<1> keys = {.keys = {key(0, 0, of_slope(4)), key(1, 0, of_slope(-4))}};
  keys.after = {.kind = OutsideKind::Repeat, .count = 1e6};
  const Curve<1> hill = make(keys);
  CHECK(hill.range(0, 1).high[0] == 1);
  CHECK(hill.range(0, 1).low[0] == 0);
  CHECK(hill.range(0.75, 1).high[0] == 0.75);
  CHECK(hill.range(10, 12345.5).high[0] == 1);
  CHECK(hill.range(1.25, 1.25).low[0] == 0.75);
  // A repeated stepNext has its first key's value only once: at the joint it has the last key's
  // value.
  CurveKeys<1> steps = {.keys = {key(0, -9, of_segment(SegmentKind::StepNext)), key(2, 5)}};
  steps.after.kind = OutsideKind::Repeat;
  CHECK(make(steps).range(0.5, 20).low[0] == 5);
  CHECK(make(steps).range(0, 20).low[0] == -9);
  keys.after.kind = OutsideKind::RepeatOffset;
  keys.keys[1].value = {1};
  keys.after.count = std::nullopt;
  CHECK(make(keys).range(0, 1e9).high[0] >= 1e9);
}

}  // namespace
}  // namespace pliant::testing
