// From the second frame on, a plate in sine space allocates nothing, nor does a union of
// rectangles. An executable of its own, since it counts all allocations of the program.

#include <cstdio>
#include <cstdlib>
#include <new>
#include <utility>

#include "pliant/core/profile.hpp"
#include "pliant/core/thread_pool.hpp"
#include "pliant/plate/solver_factories.hpp"
#include "support/count_allocations.hpp"

namespace {

using namespace pliant;

bool is_free_of_allocations(const char* name, PlateSolver& solver, PlateProblem problem) {
  const Field zero = Field::Zero(problem.outline.grid().node_count(), 3);
  PlateState state{zero, zero};
  const auto frame = [&] {
    auto next = solver.advance(problem, {20, 0.001}, std::move(state));
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
  std::printf("%s: %ld allocations ahead, %ld in frames\n", name, before, after - before);
  return before > 0 && after == before;
}

// All except a quarter.
InteriorMask three_quarters(const Grid& grid) {
  InteriorMask interior(static_cast<std::size_t>(grid.node_count()), 0);
  for (int j = 1; j < grid.rows - 1; ++j) {
    for (int i = 1; i < grid.columns - 1; ++i) {
      interior[grid.node(i, j)] = i < grid.columns / 2 || j < grid.rows / 2;
    }
  }
  return interior;
}

}  // namespace

int main() {
  ThreadPool threads(2);
  const Grid grid{130, 90, 0.01, 0.01};
  const Field load = Field::Ones(grid.node_count(), 3);
  Profile profile;
  const RunContext context{
      .threads = &threads, .profile = &profile, .should_stop = [] { return false; }};
  const auto spectral = make_plate_solver(SolverChoice::Auto, context);
  bool is_good =
      is_free_of_allocations("rectangle", *spectral, {grid, {1, 2, 1}, {40, 20}, {}, load});
  const auto schwarz = make_schwarz_solver(context);
  is_good = is_free_of_allocations("union", *schwarz,
                                   {{grid, three_quarters(grid)}, {1, 2, 1}, {40, 20}, {}, load}) &&
            is_good;
  return is_good ? 0 : 1;
}
