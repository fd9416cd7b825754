// From the second frame on, a plate in sine space allocates nothing. An executable of its own,
// since it counts all allocations of the program.

#include <cstdio>
#include <cstdlib>
#include <new>
#include <utility>

#include "pliant/core/profile.hpp"
#include "pliant/core/thread_pool.hpp"
#include "pliant/plate/plate_solver.hpp"
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

}  // namespace

int main() {
  ThreadPool threads(2);
  const Grid grid{130, 90, 0.01, 0.01};
  const Field load = Field::Ones(grid.node_count(), 3);
  Profile profile;
  const RunContext context{
      .threads = &threads, .profile = &profile, .should_stop = [] { return false; }};
  const auto spectral = make_plate_solver(SolverChoice::Auto, context);
  const bool is_good =
      is_free_of_allocations("rectangle", *spectral, {grid, {1, 2, 1}, {40, 20}, {}, load});
  return is_good ? 0 : 1;
}
