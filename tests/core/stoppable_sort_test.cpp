#include "pliant/core/stoppable_sort.hpp"

#include <numeric>
#include <random>

#include "support/stopping.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

std::vector<std::pair<int, int>> some_pairs(int count, unsigned values) {
  std::mt19937 random(7);
  std::vector<std::pair<int, int>> pairs;
  for (int k = 0; k < count; ++k) pairs.emplace_back(static_cast<int>(random() % values), k);
  return pairs;
}

Result<void> done_or_interrupted(bool is_done) {
  if (is_done) return {};
  return interrupted();
}

}  // namespace

TEST_CASE("a sort that can be stopped is a stable sort", "[core][stopping]") {
  const auto by_first = [](const auto& a, const auto& b) { return a.first < b.first; };
  for (const int count : {0, 1, 2, 8191, 8192, 8193, 50'000}) {
    auto pairs = some_pairs(count, 100), expected = pairs;
    const StopRequest never;
    StopPoll poll(never);
    REQUIRE(sort_unless_stopped(pairs, poll, by_first));
    std::stable_sort(expected.begin(), expected.end(), by_first);
    CHECK(pairs == expected);
  }
}

TEST_CASE("a selection that can be stopped puts the item of a rank in its place",
          "[core][stopping]") {
  for (const int shape : {0, 1, 2}) {  // any order, ascending, descending
    std::vector<std::pair<int, int>> pairs = some_pairs(60'000, 1000);
    if (shape > 0) std::sort(pairs.begin(), pairs.end());
    if (shape > 1) std::reverse(pairs.begin(), pairs.end());
    auto sorted = pairs;
    std::sort(sorted.begin(), sorted.end());
    for (const std::ptrdiff_t nth : {0, 1, 20'000, 30'000, 59'999}) {
      const StopRequest never;
      StopPoll poll(never);
      const auto place = pairs.begin() + nth;
      REQUIRE(select_unless_stopped(pairs.begin(), place, pairs.end(), poll, std::less<>()));
      CHECK(*place == sorted[static_cast<std::size_t>(nth)]);
      CHECK(std::all_of(pairs.begin(), place, [&](const auto& one) { return one < *place; }));
    }
  }
}

TEST_CASE("sorting and selecting are stopped", "[core][stopping]") {
  const auto pairs = some_pairs(400'000, 1'000'000);
  check_stops(
      [&](const StopRequest& should_stop) {
        auto own = pairs;
        StopPoll poll(should_stop);
        return done_or_interrupted(sort_unless_stopped(own, poll));
      },
      10);
  check_stops(
      [&](const StopRequest& should_stop) {
        auto own = pairs;
        StopPoll poll(should_stop);
        return done_or_interrupted(select_unless_stopped(own.begin(), own.begin() + 200'000,
                                                         own.end(), poll, std::less<>()));
      },
      2);
}
