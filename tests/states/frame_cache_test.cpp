#include "pliant/states/frame_cache.hpp"

#include <algorithm>
#include <random>

#include "support/catch.hpp"

using namespace pliant;

namespace {

// 6 doubles per node.
FrameCache::States states(double mark) {
  return {{Field::Constant(10, 3, mark), Field::Zero(10, 3)}};
}
constexpr std::size_t bytes = 10 * 6 * sizeof(double);

// Calls the cache as a simulation does when playing forwards.
void play(FrameCache& cache, int last) {
  for (int frame = 1; frame <= last; ++frame) {
    if (cache.wants_checkpoint(frame)) cache.keep(frame, states(frame));
  }
}

}  // namespace

TEST_CASE("within the budget every frame is kept", "[states][cache]") {
  FrameCache cache(1, 10 * bytes);
  CHECK_FALSE(cache.latest_until(5));
  for (int frame = 2; frame <= 11; ++frame) {
    REQUIRE(cache.wants_checkpoint(frame));
    cache.keep(frame, states(frame));
    CHECK_FALSE(cache.wants(frame));
  }
  for (int frame = 2; frame <= 11; ++frame) {
    CHECK(cache.latest_until(frame) == frame);
    CHECK(cache.use(frame) == states(frame));
  }
  CHECK_FALSE(cache.latest_until(1));
  CHECK(cache.latest_until(100) == 11);
  CHECK(cache.interval() == 1);
}

TEST_CASE("the first frame needs no keeping", "[states][cache]") {
  FrameCache cache(1, 10 * bytes);
  CHECK_FALSE(cache.wants(1));
  cache.keep(1, states(1));
  CHECK_FALSE(cache.latest_until(9));
}

TEST_CASE("beyond the budget every frame is within an interval that is as told",
          "[states][cache]") {
  const int room = GENERATE(1, 2, 3, 4, 7, 8, 31);
  const int count = GENERATE(1, 2, 9, 64, 1000);
  MemoryBudget memory(std::size_t{1} << 30);
  FrameCache cache(1, room * bytes, &memory);
  play(cache, 1 + count);
  CAPTURE(room, count, cache.interval());
  if (count <= room) {
    CHECK(cache.interval() == 1);
  } else {
    CHECK(cache.interval() <= 2.0 * count / (std::max(1, room / 2) + 1));
  }
  for (int frame = 1; frame <= 1 + count; ++frame) {
    const int kept = cache.latest_until(frame).value_or(1);
    CHECK(frame - kept < cache.interval());
    if (kept > 1) CHECK(cache.use(kept) == states(kept));
  }
  CHECK(memory.total() - memory.available() <= room * bytes);
}

TEST_CASE("what is left of the room goes to the frames used last", "[states][cache]") {
  FrameCache cache(0, 8 * bytes);
  play(cache, 64);  // a checkpoint every 16 frames
  REQUIRE(cache.interval() == 16);
  for (const int frame : {40, 41, 42, 43}) cache.keep(frame, states(frame));
  cache.use(40);
  cache.keep(44, states(44));
  CHECK(cache.latest_until(40) == 40);
  CHECK(cache.latest_until(41) == 40);  // 41 was the least recently used
  CHECK(cache.latest_until(44) == 44);
  for (const int frame : {16, 32, 48, 64}) CHECK(cache.latest_until(frame) == frame);
}

TEST_CASE("a cache keeps its promise whatever the order of frames", "[states][cache]") {
  std::mt19937 random(GENERATE(1, 2, 3, 4, 5));
  const int room = std::uniform_int_distribution(1, 12)(random);
  MemoryBudget memory(room * bytes);
  FrameCache cache(-5, 100 * bytes, &memory);  // the memory is the tighter limit
  play(cache, 80);
  for (int n = 0; n < 500; ++n) {
    const int frame = std::uniform_int_distribution(-5, 80)(random);
    const int kept = cache.latest_until(frame).value_or(-5);
    REQUIRE(kept <= frame);
    REQUIRE(frame - kept < cache.interval());
    if (kept > -5) REQUIRE(cache.use(kept) == states(kept));
    for (int on_the_way = kept + 1; on_the_way <= frame; ++on_the_way) {
      cache.keep(on_the_way, states(on_the_way));
    }
  }
}

TEST_CASE("kept frames count as memory, and give way", "[states][cache]") {
  MemoryBudget memory(10 * bytes);
  FrameCache cache(0, 100 * bytes, &memory);
  play(cache, 100);
  CHECK(memory.available() < 3 * bytes);
  CHECK(cache.give_way());
  CHECK(memory.available() == 10 * bytes);
  CHECK_FALSE(cache.latest_until(100));
  CHECK_FALSE(cache.give_way());
  for (int frame = 1; frame <= 100; ++frame) cache.keep(frame, states(frame));
  CHECK(memory.available() >= 5 * bytes);
}

TEST_CASE("a cache may be moved", "[states][cache]") {
  FrameCache cache(0, 4 * bytes);
  play(cache, 20);
  for (const int frame : {1, 2, 3}) cache.keep(frame, states(frame));
  FrameCache moved = std::move(cache);
  for (int frame = 20; frame > 0; --frame) moved.keep(frame, states(frame));
  const auto kept = moved.latest_until(20);
  REQUIRE(kept);
  CHECK(moved.use(*kept) == states(*kept));
}

TEST_CASE("no budget keeps nothing", "[states][cache]") {
  MemoryBudget memory(bytes - 1);
  FrameCache none(1, 0), small(1, bytes - 1), poor(1, 100 * bytes, &memory);
  CHECK_FALSE(none.wants(2));
  for (FrameCache* cache : {&none, &small, &poor}) {
    cache->keep(2, states(2));
    CHECK_FALSE(cache->latest_until(9));
    CHECK_FALSE(cache->wants(3));
    CHECK_FALSE(cache->give_way());
  }
}
