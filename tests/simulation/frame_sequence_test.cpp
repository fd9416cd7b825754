#include "pliant/simulation/frame_sequence.hpp"

#include <limits>
#include <vector>

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("a sequence of frames holds both of its ends, each frame once", "[simulation]") {
  const FrameSequence frames(-2, 3);
  CHECK(std::vector<int>(frames.begin(), frames.end()) == std::vector<int>{-2, -1, 0, 1, 2, 3});
  CHECK(frames.size() == 6);
  CHECK(FrameSequence(5, 5).size() == 1);
  CHECK(FrameSequence(5, 4).begin() == FrameSequence(5, 4).end());
}

TEST_CASE("a sequence may end with the last int", "[simulation]") {
  constexpr int last = std::numeric_limits<int>::max();
  const FrameSequence frames(last - 1, last);
  CHECK(std::vector<int>(frames.begin(), frames.end()) == std::vector<int>{last - 1, last});
}
