#include "pliant/timeline/compile.hpp"

#include <cmath>

#include "support/catch.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

CurveKeys<1> bold(double out, double in, Overshoot policy) {
  CurveKeys<1> keys;
  keys.keys = {key(0, 0), key(10, 3)};
  keys.keys[0].out = of_slope(1, out);
  keys.keys[1].in = of_slope(1, in);
  keys.overshoot = policy;
  return keys;
}

TEST_CASE("each correction is noted with key, old and new length", "[timeline][compile]") {
  const Curve<1> contained = make(bold(25, 12.5, Overshoot::Contain));
  REQUIRE(contained.notes().size() == 2);
  CHECK(contained.notes()[0].key == 0);
  CHECK(contained.notes()[0].message ==
        "out tangent shortened from 25 to 10 frames: no tangent may be longer than its segment of "
        "10 frames");
  CHECK(contained.notes()[1].key == 1);
  CHECK(contained.notes()[1].message ==
        "in tangent shortened from 12.5 to 10 frames: no tangent may be longer than its segment of "
        "10 frames");
  const Curve<1> limited = make(bold(30, 30, Overshoot::Limit));
  REQUIRE(limited.notes().size() == 2);
  CHECK(limited.notes()[1].message ==
        "in tangent shortened from 30 to 10 frames: time would run backwards otherwise");
  const Curve<1> kept = make(bold(12, 0, Overshoot::KeepStart));
  REQUIRE(kept.notes().size() == 1);
  CHECK(kept.notes()[0].message.find("in tangent lengthened from 0 to 0.5") == 0);
  CHECK(make(bold(13, 4, Overshoot::Limit)).notes().empty());
}

TEST_CASE("overshoot = error refuses and blames the longer tangent", "[timeline][compile]") {
  const auto out = Curve<1>::make(bold(25, 5, Overshoot::Error));
  REQUIRE(!out);
  CHECK(out.error().index == 0);
  CHECK(out.error().message ==
        "out tangent reaches 25 frames into a segment of 10 frames: time would run backwards, "
        "which overshoot=\"error\" does not allow");
  const auto in = Curve<1>::make(bold(5, 25, Overshoot::Error));
  REQUIRE(!in);
  CHECK(in.error().index == 1);
  CHECK(Curve<1>::make(bold(10, 10, Overshoot::Error)).has_value());
}

TEST_CASE("handles that point backwards count as none", "[timeline][compile]") {
  CurveKeys<1> keys = {.keys = {key(0, 0), key(10, 3)}};
  keys.keys[0].out = of_handle(-2, 5);
  keys.keys[1].in = of_handle(1, 5);
  const Curve<1> curve = make(keys);
  REQUIRE(curve.notes().size() == 2);
  CHECK(curve.notes()[0].message ==
        "out handle points backwards in time (-2 frames) and is treated as having no length");
  keys.keys[0].out = of_handle(0, 0);
  keys.keys[1].in = of_handle(0, 0);
  for (double t = 0; t <= 10; t += 0.5) CHECK(at(curve, t) == at(make(keys), t));
}

TEST_CASE("a negative length counts as none", "[timeline][compile]") {
  const Curve<1> curve = make(bold(-1, 4, Overshoot::Limit));
  REQUIRE(curve.notes().size() == 1);
  CHECK(curve.notes()[0].key == 0);
  CHECK(curve.notes()[0].message ==
        "out tangent has the negative length -1 and is treated as having no length");
  for (double t = 0; t <= 10; t += 0.5) {
    CHECK(at(curve, t) == at(make(bold(0, 4, Overshoot::Limit)), t));
  }
}

TEST_CASE("left after a step has no effect but a note", "[timeline][compile]") {
  const Curve<1> curve = make({key(0, 1, of_segment(SegmentKind::Step)), with_left(key(2, 5), 3)});
  REQUIRE(curve.notes().size() == 1);
  CHECK(curve.notes()[0].key == 1);
  CHECK(curve.notes()[0].message ==
        "left has no effect: the segment before is a step, which keeps its value");
  CHECK(curve.left_value(2)[0] == 1);
}

TEST_CASE("a note stands once, however many copies the loop makes", "[timeline][compile]") {
  CurveKeys<1> keys = bold(30, 30, Overshoot::Contain);
  keys.loop = Loop<1>{.from = 0, .to = 20, .after = 9};
  CHECK(make(keys).notes().size() == 2);
}

TEST_CASE("slopes beyond all numbers are an error", "[timeline][compile]") {
  CurveKeys<1> keys = {.keys = {key(0, 0), key(1e-300, 1e100), key(1, 2e100)}};
  const auto curve = Curve<1>::make(with_kinds(keys, TangentKind::Spline));
  REQUIRE(!curve);
  CHECK(curve.error().message.find("overflows within its segment") != std::string::npos);
  for (Key<1>& each : keys.keys) each.next.kind = SegmentKind::Linear;
  CHECK(Curve<1>::make(keys).has_value());  // the slopes are not read
}

TEST_CASE("segments arrive at left values, except steps", "[timeline][compile]") {
  for (const auto kind : {SegmentKind::StepNext, SegmentKind::Linear, SegmentKind::Bezier,
                          SegmentKind::Easing, SegmentKind::CubicBezier}) {
    const Curve<1> curve = make({key(0, 1, of_segment(kind)), with_left(key(2, 5), 3)});
    CAPTURE(static_cast<int>(kind));
    CHECK(at(curve, 0) == 1);
    CHECK(at(curve, 2) == 5);
    CHECK(curve.left_value(2)[0] == 3);
    CHECK_THAT(at(curve, 2 - 1e-12), WithinAbs(3, 1e-9));
  }
}

TEST_CASE("vertical handles have an infinite velocity, straight ones a finite one",
          "[timeline][compile]") {
  CurveKeys<1> keys = {.keys = {key(0, 0), key(2, 3)}};
  keys.keys[0].out = of_handle(0, 1);
  keys.keys[1].in = of_handle(0, 0);
  const Curve<1> curve = make(keys);
  CHECK(std::isinf(curve.velocity(0)[0]));
  CHECK(curve.velocity(0)[0] > 0);
  // A handle without length: the curve leaves towards the other handle, (2, 3).
  CHECK_THAT(curve.left_velocity(2)[0], WithinAbs((3.0 - 1.0) / 2, 1e-14));
  keys.keys[0].out = of_handle(0, 0);
  CHECK_THAT(make(keys).velocity(0)[0], WithinAbs(1.5, 1e-14));
}

}  // namespace
}  // namespace pliant::testing
