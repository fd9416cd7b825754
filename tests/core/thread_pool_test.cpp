#include "pliant/core/thread_pool.hpp"

#include <stdexcept>
#include <string>
#include <vector>

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("each index is worked on once, whatever the number of threads", "[core][threads]") {
  for (const int threads : {1, 2, 3, 8}) {
    ThreadPool pool(threads);
    CHECK(pool.thread_count() == threads);
    for (const std::size_t count : {0, 1, 2, 7, 1000}) {
      std::vector<int> times(count);
      pool.for_each(count, [&](std::size_t index) { ++times[index]; });
      CHECK(times == std::vector<int>(count, 1));
    }
  }
}

TEST_CASE("what the work throws arrives, and the pool goes on", "[core][threads]") {
  for (const int threads : {1, 2, 5}) {
    ThreadPool pool(threads);
    CHECK_THROWS_WITH(pool.for_each(100,
                                    [](std::size_t index) {
                                      if (index % 10 == 3) {
                                        throw std::runtime_error(std::to_string(index));
                                      }
                                    }),
                      "3");
    std::vector<int> times(50);
    pool.for_each(50, [&](std::size_t index) { ++times[index]; });
    CHECK(times == std::vector<int>(50, 1));
  }
}
