#include "pliant/plate/solver_cache.hpp"

#include "pliant/core/memory_budget.hpp"
#include "support/catch.hpp"
#include "support/plates.hpp"

using namespace pliant;
using pliant::testing::unit_grid;

TEST_CASE("each outline keeps its solver while it is among those of the frame",
          "[plate][solver_cache]") {
  SolverCache cache(SolverChoice::Eigen);
  const Outline large = unit_grid(13, 9), small = unit_grid(5, 5);
  const auto solve = [&](const Outline& outline) {
    const Field zero = Field::Zero(outline.grid().node_count(), 3);
    const Field ones = Field::Ones(outline.grid().node_count(), 3);
    const PlateProblem problem{outline, {1, 2, 1}, {}, {}, ones};
    return cache.solver_of(outline).advance(problem, {1, 0.1}, {zero, zero})->displacement;
  };
  const std::vector<Outline> both{large, small, small};
  Field first;
  for (int frame = 0; frame < 5; ++frame) {
    cache.keep_only(both);
    first = solve(large);
    solve(small);
    solve(small);
  }
  CHECK(cache.counts().factorizations == 2);
  CHECK(cache.counts().solves == 15);
  cache.keep_only({&both[1], 1});
  solve(small);
  CHECK(cache.counts().factorizations == 2);
  CHECK(solve(large) == first);  // computed again, with the same bits
  CHECK(cache.counts().factorizations == 3);
  CHECK(cache.counts().solves == 17);  // includes those of the destroyed solver
}

TEST_CASE("solvers that are let go give their memory back", "[plate][solver_cache]") {
  MemoryBudget budget(1'000'000);
  SolverCache cache(SolverChoice::Auto, {.memory = &budget});
  const Outline outline = unit_grid(21, 21);
  const Field zero = Field::Zero(21 * 21, 3);
  const PlateProblem problem{outline, {1, 2, 1}, {}, {}, zero};
  REQUIRE(cache.solver_of(outline).advance(problem, {1, 0.1}, {zero, zero}));
  CHECK(budget.available() < 900'000);
  cache.keep_only({});
  CHECK(budget.available() == 1'000'000);
}
