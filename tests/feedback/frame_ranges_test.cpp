#include "pliant/feedback/frame_ranges.hpp"

#include <random>
#include <set>
#include <string>

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("frames are told as an author would", "[feedback][frame_ranges]") {
  FrameRanges ranges;
  CHECK(ranges.to_string().empty());
  for (const int frame : {5, 3, 12, 4, 4, 6, -2}) ranges.add(frame);
  CHECK(ranges.to_string() == "-2, 3-6, 12");
}

TEST_CASE("of many ranges the first are told", "[feedback][frame_ranges]") {
  FrameRanges ranges;
  for (int frame = 0; frame < 1000; frame += 2) ranges.add(frame);
  CHECK(ranges.to_string(3) == "0, 2, 4 and 497 more ranges to 998");
  CHECK(ranges.to_string(499) == ranges.to_string());  // a summary of one range would be as long
  ranges.add(1);
  CHECK(ranges.to_string(2) == "0-2, 4 and 497 more ranges to 998");
}

TEST_CASE("frames of two sets are added up", "[feedback][frame_ranges]") {
  std::mt19937 random(5);
  for (int trial = 0; trial < 200; ++trial) {
    FrameRanges a, b, both;
    for (int k = 0; k < 12; ++k) {
      const int first = static_cast<int>(random() % 40), second = static_cast<int>(random() % 40);
      a.add(first);
      b.add(second);
      both.add(first);
      both.add(second);
    }
    a.add(b);
    CHECK(a.ranges() == both.ranges());
  }
}

TEST_CASE("ranges hold just the frames that were added, never adjacent",
          "[feedback][frame_ranges]") {
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
