#include "pliant/timeline/key_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/catch.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

using timeline::KeySearch;

std::size_t slow(const std::vector<double>& frames, double frame) {
  const auto after = std::upper_bound(frames.begin(), frames.end(), frame) - frames.begin();
  return std::min<std::size_t>(after > 0 ? after - 1 : 0,
                               frames.size() > 1 ? frames.size() - 2 : 0);
}

TEST_CASE("the search finds the later segment at a key", "[timeline][key_search]") {
  Whim whim(81);
  for (int round = 0; round < 400; ++round) {
    // Gaps of many orders of magnitude: nearly all keys share one bucket.
    std::vector<double> frames = {whim.between(-100, 100)};
    const double least = whim.once_in(2) ? -9 : 0;
    const int count = 1 + whim.upto(40);
    while (static_cast<int>(frames.size()) < count) {
      frames.push_back(frames.back() + whim.size(least, 3));
    }
    const KeySearch search(frames);
    for (const double frame : frames) {
      CAPTURE(round, frame);
      REQUIRE(search.segment_at(frames, frame) == slow(frames, frame));
      const double after = std::nextafter(frame, 1e300);
      REQUIRE(search.segment_at(frames, after) == slow(frames, after));
      if (frame == frames.front()) continue;
      const double before = std::nextafter(frame, -1e300);
      REQUIRE(search.segment_at(frames, before) == slow(frames, before));
    }
    for (int i = 0; i < 20; ++i) {
      const double frame = whim.between(frames.front(), frames.back());
      CAPTURE(round, frame);
      REQUIRE(search.segment_at(frames, frame) == slow(frames, frame));
    }
  }
}

TEST_CASE("frames that are no place in time find some segment", "[timeline][key_search]") {
  const std::vector<double> frames = {0, 1, 2, 5e-324 + 3};
  const KeySearch search(frames);
  for (const double frame : {std::numeric_limits<double>::quiet_NaN(), -1e300, 1e300,
                             std::numeric_limits<double>::infinity()}) {
    CHECK(search.segment_at(frames, frame) <= 2);
  }
  const std::vector<double> close = {0, 5e-324, 1e-323};
  CHECK(KeySearch(close).segment_at(close, 5e-324) == 1);
  CHECK(KeySearch(close).segment_at(close, 0) == 0);
}

}  // namespace
}  // namespace pliant::testing
