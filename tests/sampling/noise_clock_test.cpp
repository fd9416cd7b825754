#include "pliant/sampling/noise_clock.hpp"

#include <atomic>
#include <thread>
#include <vector>

#include "support/catch.hpp"

using namespace pliant;

namespace {

// Values whose sum depends on the order.
double rate_at(int frame) { return 0.1 + 1e-3 * (frame % 17) + 1e7 * (frame % 3 == 0 ? 1 : 0); }

double sum_by_hand(int start, int frame) {
  double sum = rate_at(start) * start;
  for (int before = start; before < frame; ++before) sum += rate_at(before);
  return sum;
}

// Number of evaluations of the rate when frames are played in order, each for two surfaces.
int evaluations(int frames) {
  NoiseClock clock(5);
  int count = 0;
  for (int frame = 5; frame <= 5 + frames; ++frame) {
    for (int surface = 0; surface < 2; ++surface) {
      clock.sum(frame, [&](int at) {
        ++count;
        return rate_at(at);
      });
    }
  }
  return count;
}

}  // namespace

TEST_CASE("a keyed rate is asked for once a frame", "[sampling][noise]") {
  CHECK(evaluations(1000) == 1001);  // the first frame's rate is also used for the time before it
  CHECK(evaluations(2000) == 2001);
}

TEST_CASE("a noise clock tells the same in any order", "[sampling][noise]") {
  const int start = GENERATE(-300, 0, 64, 1000);
  NoiseClock clock(start);
  unsigned random = 1;
  for (int round = 0; round < 300; ++round) {
    random = random * 1103515245U + 12345U;
    const int frame = start + static_cast<int>(random >> 16U) % 1000;
    CAPTURE(start, frame);
    REQUIRE(clock.sum(frame, rate_at) == sum_by_hand(start, frame));
  }
}

TEST_CASE("a noise clock may be asked from many threads at once", "[sampling][noise][threads]") {
  NoiseClock clock(0);
  std::atomic<int> wrong = 0;
  std::vector<std::jthread> threads;
  for (int thread = 0; thread < 8; ++thread) {
    threads.emplace_back([&, thread] {
      for (int k = 0; k < 100; ++k) {
        const int frame = (k * 37 + thread * 101) % 500;
        if (clock.sum(frame, rate_at) != sum_by_hand(0, frame)) ++wrong;
      }
    });
  }
  threads.clear();
  CHECK(wrong == 0);
}

TEST_CASE("a frame that was passed costs a stride at most", "[sampling][noise]") {
  NoiseClock clock(0);
  clock.sum(10'000, rate_at);
  for (const int frame : {9'999, 0, 63, 64, 5'000, 4'999}) {
    int count = 0;
    clock.sum(frame, [&](int at) {
      ++count;
      return rate_at(at);
    });
    CAPTURE(frame);
    CHECK(count < NoiseClock::stride);
  }
}
