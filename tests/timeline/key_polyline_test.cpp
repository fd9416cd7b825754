#include "pliant/timeline/key_polyline.hpp"

#include "support/catch.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

using timeline::key_polyline_of;
using timeline::KeyPolyline;

TEST_CASE("secants end at left values", "[timeline][polyline]") {
  const CurveKeys<1> keys = {.keys = {key(0, 0), with_left(key(2, 5), 4), key(3, 9)}};
  const KeyPolyline polyline = key_polyline_of(keys.keys, keys.before, keys.after, 0);
  CHECK(polyline.secants == std::vector<double>{2, 4});
  CHECK(polyline.range() == 9);
  CHECK(polyline.at(1, false).is_open());
  CHECK(polyline.at(1, true).secant_after == 4);
}

TEST_CASE("a curve is periodic when a side repeats without a jump", "[timeline][polyline]") {
  CurveKeys<1> keys = {.keys = {key(0, 1), key(2, 5), key(3, 1)}};
  const auto is_periodic = [&] {
    return key_polyline_of(keys.keys, keys.before, keys.after, 0).is_periodic;
  };
  CHECK(!is_periodic());
  keys.after.kind = OutsideKind::Repeat;
  CHECK(is_periodic());
  keys.keys[2].value = {2};
  CHECK(!is_periodic());
  keys.before.kind = OutsideKind::RepeatOffset;
  CHECK(is_periodic());
  keys.keys[0].left = Value<1>{0};
  CHECK(!is_periodic());
  keys.keys[0].left = std::nullopt;
  keys.before.kind = keys.after.kind = OutsideKind::Mirror;
  CHECK(!is_periodic());
}

TEST_CASE("at the seam the last segment meets the first", "[timeline][polyline]") {
  CurveKeys<1> keys = {.keys = {key(0, 1), key(2, 5), key(3, 1)}};
  keys.after.kind = OutsideKind::Repeat;
  const KeyPolyline polyline = key_polyline_of(keys.keys, keys.before, keys.after, 0);
  for (const std::size_t end : {0, 2}) {
    CHECK(polyline.at(end, true).secant_before == -4);
    CHECK(polyline.at(end, true).secant_after == 2);
    CHECK(polyline.at(end, true).is_extremum());
    CHECK(polyline.at(end, true).spline() == 0);  // (5 - 5) / (1 + 2)
  }
}

}  // namespace
}  // namespace pliant::testing
