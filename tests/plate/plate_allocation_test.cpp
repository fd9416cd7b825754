// From the second frame on a plate in sine space allocates nothing. An executable of its own, since
// it counts what everyone allocates.

#include <cstdio>
#include <cstdlib>
#include <new>
#include <utility>

#include "pliant/plate/plate_solver.hpp"
#include "support/count_allocations.hpp"

int main() {
  using namespace pliant;
  ThreadPool threads(2);
  const auto solver = make_plate_solver(SolverChoice::Auto, nullptr, &threads);
  const Grid grid{130, 90, 0.01, 0.01};
  PlateProblem problem{grid, {1, 2, 1}, {40, 20}, {}, Field::Ones(grid.node_count(), 3)};
  PlateState state{Field::Zero(grid.node_count(), 3), Field::Zero(grid.node_count(), 3)};
  const auto frame = [&] {
    auto next = solver->advance(problem, {20, 0.001}, std::move(state), [] { return false; });
    if (!next) std::abort();
    state = *std::move(next);
  };
  frame();
  const long before = testing::allocations;
  for (int k = 0; k < 5; ++k) {
    problem.stiffness.c += 0.01;  // other coefficients too
    frame();
  }
  const long after = testing::allocations;
  std::printf("%ld allocations ahead, %ld in frames\n", before, after - before);
  return before > 0 && after == before ? 0 : 1;
}
