#include "pliant/exchange/single.hpp"

#include <random>

#include "support/catch.hpp"

namespace pliant::exchange {
namespace {

TEST_CASE("numbers in single precision get the fewest digits", "[exchange][single]") {
  CHECK(shortest_of_single(static_cast<double>(0.1F)) == 0.1);
  CHECK(shortest_of_single(static_cast<double>(-8000.3F)) == -8000.3);
  CHECK(shortest_of_single(0) == 0);
  CHECK(shortest_of_single(0.1) == 0.1);  // is none of single precision
  CHECK(shortest_of_single(1.0 / 3) == 1.0 / 3);
}

TEST_CASE("a frame comes back from its time in single precision", "[exchange][single]") {
  std::mt19937 bits(4);
  for (const double fps : {24.0, 24000.0 / 1001, 30.0, 60.0, 120.0}) {
    for (int k = 0; k < 2000; ++k) {
      const double frame =
          static_cast<double>(std::uniform_int_distribution<int>(1, 200'000)(bits)) / 100;
      CAPTURE(fps, frame);
      CHECK(frame_of_seconds(static_cast<double>(seconds_of_frame(frame, fps, 1)), fps, 1) ==
            frame);
    }
  }
  // No frame with few digits has this time.
  CHECK(frame_of_seconds(1.0 / 3, 24, 0) == 8);
  CHECK(frame_of_seconds(0.123456789012345, 24, 0) == 0.123456789012345 * 24);
}

}  // namespace
}  // namespace pliant::exchange
