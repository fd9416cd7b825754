#include "pliant/timeline/arms.hpp"

#include "support/catch.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

using timeline::Arm;
using timeline::arm_of;

TEST_CASE("both arms of a segment point into it", "[timeline][arms]") {
  std::vector<std::string> changes;
  const Arm<1> out = arm_of<1>(of_handle(2, 3), {}, 9, true, changes);
  CHECK(out.length == 2);
  CHECK(out.rise == Value<1>{3});
  const Arm<1> in = arm_of<1>(of_handle(-2, 3), {}, 9, false, changes);
  CHECK(in.length == 2);
  CHECK(in.rise == Value<1>{-3});
  CHECK(changes.empty());
}

TEST_CASE("a third of the segment is the default and exact", "[timeline][arms]") {
  std::vector<std::string> changes;
  const Arm<1> arm = arm_of<1>(of_slope(2), {2}, 0.1, true, changes);
  CHECK(arm.is_third);
  CHECK(arm.frame_rate({0.1, 1e-20}).high == 0.1);
  CHECK(arm.frame_rate({0.1, 1e-20}).low == 1e-20);
  CHECK(arm.value_rate(0.1) == Value<1>{0.2});
}

TEST_CASE("another length scales a vector and keeps a slope", "[timeline][arms]") {
  std::vector<std::string> changes;
  const Arm<1> vector = arm_of<1>(of_handle(4, 6), {}, 9, true, changes).with_length(2);
  CHECK(vector.value_rate(9) == Value<1>{9});
  const Arm<1> slope = arm_of<1>(of_slope(5, 4), {5}, 9, true, changes).with_length(2);
  CHECK(slope.value_rate(9) == Value<1>{30});
  const Arm<1> upright = arm_of<1>(of_handle(0, 6), {}, 9, true, changes).with_length(2);
  CHECK(upright.value_rate(9) == Value<1>{18});
  CHECK(upright.frame_rate({9, 0}).high == 6);
}

}  // namespace
}  // namespace pliant::testing
