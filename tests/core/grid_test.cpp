#include "pliant/core/grid.hpp"

#include <random>

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("a box grows to the extremes of what it includes", "[core][grid]") {
  Box box;
  CHECK(box.is_empty());
  box.include(3, 7);
  CHECK(box == Box{3, 3, 7, 7});
  box.include(5, 2);
  CHECK(box == Box{3, 5, 2, 7});
  box.include(Box{});
  CHECK(box == Box{3, 5, 2, 7});
  box.include(Box{0, 1, 9, 9});
  CHECK(box == Box{0, 5, 2, 9});
  CHECK(box.columns() == 6);
  CHECK(box.rows() == 8);
}

TEST_CASE("an intersection holds just the nodes that both boxes hold", "[core][grid]") {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> coordinate(0, 9);
  for (int trial = 0; trial < 500; ++trial) {
    Box a, b;
    for (Box* box : {&a, &b}) {
      box->include(coordinate(random), coordinate(random));
      box->include(coordinate(random), coordinate(random));
    }
    const Box both = intersection(a, b);
    bool any = false;
    for (int j = 0; j < 10; ++j) {
      for (int i = 0; i < 10; ++i) {
        const bool expected = a.contains(i, j) && b.contains(i, j);
        REQUIRE(both.contains(i, j) == expected);
        any = any || expected;
      }
    }
    REQUIRE(both.is_empty() == !any);
  }
}
