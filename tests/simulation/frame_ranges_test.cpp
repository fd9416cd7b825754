#include "pliant/simulation/frame_ranges.hpp"

#include <random>
#include <set>
#include <string>

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("frames are told as an author would", "[simulation][frame_ranges]") {
  FrameRanges ranges;
  CHECK(ranges.to_string().empty());
  for (const int frame : {5, 3, 12, 4, 4, 6, -2}) ranges.add(frame);
  CHECK(ranges.to_string() == "-2, 3-6, 12");
}

TEST_CASE("ranges hold just the frames that were added, never adjacent",
          "[simulation][frame_ranges]") {
  std::mt19937 random(23);
  for (int trial = 0; trial < 200; ++trial) {
    FrameRanges ranges;
    std::set<int> frames;
    for (int k = 0; k < 25; ++k) {
      const int frame = static_cast<int>(random() % 30);
      ranges.add(frame);
      frames.insert(frame);
    }
    std::set<int> held;
    int before = -10;
    for (const auto& [first, last] : ranges.ranges()) {
      REQUIRE(first > before + 1);
      REQUIRE(first <= last);
      for (int frame = first; frame <= last; ++frame) held.insert(frame);
      before = last;
    }
    REQUIRE(held == frames);
  }
}
