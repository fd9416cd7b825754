#include "pliant/timeline/edit/preserve.hpp"

#include "support/catch.hpp"
#include "support/sanitized.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

TEST_CASE("a tangent that would change is written as a number", "[timeline][preserve]") {
  CurveKeys<1> keys{{key(0, 0), key(10, 4), key(20, 9), key(30, 20)}};
  keys.keys[1].out.length = 7;
  const auto shape = timeline::shape_of(keys);
  REQUIRE(shape);
  CHECK(timeline::preserved(keys, *shape)->keys() == keys);

  CurveKeys<1> moved = keys;
  moved.keys[0].value[0] = -5;
  const Curve<1> curve = timeline::preserved(moved, *shape).value();
  CHECK(curve.keys().keys[1].out.kind == TangentKind::Slope);
  CHECK(curve.keys().keys[1].out.slope == *shape->keys[1].out);
  CHECK(curve.keys().keys[1].out.length == 7);
  CHECK(curve.keys().keys[2].in.kind == TangentKind::Auto);
}

TEST_CASE("a linear end that would change is written as a slope", "[timeline][preserve]") {
  CurveKeys<1> keys{{key(0, 0, of_segment(SegmentKind::Linear)), key(10, 5)}};
  keys.after.kind = OutsideKind::Linear;
  const auto shape = timeline::shape_of(keys);
  keys.keys[0].value[0] = 1;
  const Curve<1> curve = timeline::preserved(keys, *shape).value();
  CHECK(curve.keys().after.kind == OutsideKind::Slope);
  CHECK(curve.keys().after.slope[0] == 0.5);
}

TEST_CASE("written corrections leave nothing to correct", "[timeline][preserve]") {
  Whim whim(1);
  for (int round = 0; round < rounds(2000); ++round) {
    CurveKeys<1> keys = whim.keys(5);
    const Curve<1> before = make(keys);
    timeline::write_corrections(keys, keys.overshoot);
    const Curve<1> after = make(keys);
    bool is_clean = true;
    for (const CurveNote& note : after.notes()) {
      is_clean = is_clean && note.message.find("shortened") == std::string::npos &&
                 note.message.find("lengthened") == std::string::npos;
    }
    const double t = whim.between(keys.keys.front().frame, keys.keys.back().frame + 1e-9);
    CAPTURE(round, t);
    REQUIRE(is_clean);
    const auto range = before.range(t - 1e-12, t + 1e-12);
    REQUIRE(at(after, t) >= range.low[0] - 1e-10);
    REQUIRE(at(after, t) <= range.high[0] + 1e-10);
  }
}

}  // namespace
}  // namespace pliant::testing
