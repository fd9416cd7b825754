#include "pliant/timeline/channel.hpp"

#include "support/catch.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

TEST_CASE("a channel is a constant or a curve", "[timeline][channel]") {
  const Channel<1> constant = 3.0;
  CHECK(!constant.is_animated());
  CHECK(constant.at(100)[0] == 3);
  const Channel<1> animated = make({key(0, 1), key(4, 2)});
  CHECK(animated.is_animated());
  CHECK(animated.at(4)[0] == 2);
  CHECK(animated.at(2) == animated.curve().value(2));
}

TEST_CASE("a switch steps between false and true", "[timeline][channel]") {
  CHECK(Switch(true).at(7));
  CHECK(!Switch(false).at(7));
  const Switch blinking = make({key(0, 0, of_segment(SegmentKind::Step)),
                                key(5, 1, of_segment(SegmentKind::Step)), key(6, 0)});
  CHECK(!blinking.at(4.999));
  CHECK(blinking.at(5));
  CHECK(!blinking.at(6));
}

}  // namespace
}  // namespace pliant::testing
