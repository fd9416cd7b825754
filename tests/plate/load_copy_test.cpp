#include "pliant/plate/load_copy.hpp"

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("a copy of a load that does not fit is called that", "[plate][memory]") {
  MemoryBudget budget(10'000);
  LoadCopy copy(&budget);
  const Grid grid{20, 30, 1, 1};
  PlateProblem problem{grid, {}, {}, {}, Field::Random(600, 3)};
  const auto refused = copy.take(problem);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::OutOfMemory);
  CHECK(refused.error().message ==
        "a copy of the load on 600 nodes needs 14.4 kB, more than the 10 kB left of the 10 kB "
        "allowed");
  CHECK(copy.memory() == 0);
  CHECK(budget.available() == 10'000);
  problem.load = Field::Random(100, 3);
  REQUIRE(copy.take(problem));
  CHECK(copy.nodes() == problem.load);
  CHECK(copy.memory() == 2'400);
}
