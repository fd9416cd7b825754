#include "pliant/timeline/segment_handle.hpp"

#include "support/catch.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

using timeline::segment_handle_of;
using timeline::SegmentHandle;

TEST_CASE("both handles of a segment point into it", "[timeline][handles]") {
  std::vector<std::string> changes;
  const SegmentHandle<1> out = segment_handle_of<1>(of_handle(2, 3), {}, 9, true, changes);
  CHECK(out.length == 2);
  CHECK(out.rise == Value<1>{3});
  const SegmentHandle<1> in = segment_handle_of<1>(of_handle(-2, 3), {}, 9, false, changes);
  CHECK(in.length == 2);
  CHECK(in.rise == Value<1>{-3});
  CHECK(changes.empty());
}

TEST_CASE("a third of the segment is the default and exact", "[timeline][handles]") {
  std::vector<std::string> changes;
  const SegmentHandle<1> handle = segment_handle_of<1>(of_slope(2), {2}, 0.1, true, changes);
  CHECK(handle.is_third);
  CHECK(handle.frame_rate({0.1, 1e-20}).high == 0.1);
  CHECK(handle.frame_rate({0.1, 1e-20}).low == 1e-20);
  CHECK(handle.value_rate(0.1) == Value<1>{0.2});
}

TEST_CASE("another length scales a vector and keeps a slope", "[timeline][handles]") {
  std::vector<std::string> changes;
  const SegmentHandle<1> vector =
      segment_handle_of<1>(of_handle(4, 6), {}, 9, true, changes).with_length(2);
  CHECK(vector.value_rate(9) == Value<1>{9});
  const SegmentHandle<1> slope =
      segment_handle_of<1>(of_slope(5, 4), {5}, 9, true, changes).with_length(2);
  CHECK(slope.value_rate(9) == Value<1>{30});
  const SegmentHandle<1> upright =
      segment_handle_of<1>(of_handle(0, 6), {}, 9, true, changes).with_length(2);
  CHECK(upright.value_rate(9) == Value<1>{18});
  CHECK(upright.frame_rate({9, 0}).high == 6);
}

}  // namespace
}  // namespace pliant::testing
