#include "pliant/timeline/loop.hpp"

#include <cmath>

#include "support/catch.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

CurveKeys<1> looped(int before, int after) {
  CurveKeys<1> keys;
  keys.keys = {key(-20, 9), key(-3, 7), key(0, 1), key(1, 4), with_left(key(3, 2), 3),
               key(4, 8),   key(9, 5),  key(30, 6)};
  keys.loop = Loop<1>{.from = 0, .to = 4, .before = before, .after = after, .offset = {0.5}};
  return keys;
}

CurveKeys<1> copies_written_out(int before, int after) {
  CurveKeys<1> keys;
  const double start = -4.0 * before;
  const double end = 4.0 + 4.0 * after;
  for (const Key<1>& each : looped(0, 0).keys) {
    if (each.frame < start) keys.keys.push_back(each);
  }
  for (int n = -before; n <= after; ++n) {
    keys.keys.push_back(key(0 + 4 * n, 1 + 0.5 * n));
    keys.keys.push_back(key(1 + 4 * n, 4 + 0.5 * n));
    keys.keys.push_back(with_left(key(3 + 4 * n, 2 + 0.5 * n), 3 + 0.5 * n));
  }
  keys.keys.push_back(key(end, 1 + 0.5 * (after + 1)));
  for (const Key<1>& each : looped(0, 0).keys) {
    if (each.frame > end) keys.keys.push_back(each);
  }
  return keys;
}

TEST_CASE("an inner loop equals the curve with the copies written out", "[timeline][loop]") {
  for (const auto& [before, after] : {std::pair{0, 1}, {1, 0}, {2, 3}, {0, 6}, {5, 0}}) {
    for (const auto kind : {TangentKind::Auto, TangentKind::Smooth, TangentKind::Spline}) {
      for (const auto outside : {OutsideKind::Hold, OutsideKind::RepeatOffset}) {
        CurveKeys<1> keys = with_kinds(looped(before, after), kind);
        CurveKeys<1> written = with_kinds(copies_written_out(before, after), kind);
        keys.before.kind = written.before.kind = outside;
        keys.after.kind = written.after.kind = outside;
        const Curve<1> curve = make(keys);
        const Curve<1> reference = make(written);
        for (double t = -50; t < 50; t += 0.125) {
          CAPTURE(before, after, t);
          REQUIRE(at(curve, t) == at(reference, t));
          REQUIRE(curve.left_value(t) == reference.left_value(t));
          REQUIRE(curve.velocity(t) == reference.velocity(t));
        }
      }
    }
  }
}

TEST_CASE("a loop without copies changes nothing, and says so", "[timeline][loop]") {
  CurveKeys<1> plain = looped(0, 0);
  plain.loop = std::nullopt;
  const Curve<1> curve = make(looped(0, 0));
  for (double t = -25; t < 35; t += 0.5) CHECK(at(curve, t) == at(make(plain), t));
  REQUIRE(curve.notes().size() == 1);
  CHECK(curve.notes()[0].message == "the loop has no copies and no effect");
}

TEST_CASE("hidden keys are noted", "[timeline][loop]") {
  const Curve<1> curve = make(looped(1, 1));
  REQUIRE(curve.notes().size() == 2);  // frames -3 and 4; frame 9 is after the last copy's end 8
  CHECK(curve.notes()[0].key == 1);
  CHECK(curve.notes()[1].key == 5);
  CHECK(curve.notes()[0].message ==
        "key at frame -3 is hidden by the loop, which covers frames -4 to 8");
}

TEST_CASE("a vector's offset has one number per component", "[timeline][loop]") {
  CurveKeys<3> keys;
  keys.keys = {{.frame = 0, .value = {1, 2, 3}}, {.frame = 1, .value = {4, 5, 6}}};
  keys.loop = Loop<3>{.from = 0, .to = 2, .after = 2, .offset = {10, 20, 30}};
  const Curve<3> curve = Curve<3>::make(keys).value();
  CHECK(curve.value(4) == Value<3>{21, 42, 63});
  CHECK(curve.value(5) == Value<3>{24, 45, 66});
  CHECK(curve.value(6) == Value<3>{31, 62, 93});
}

}  // namespace
}  // namespace pliant::testing
