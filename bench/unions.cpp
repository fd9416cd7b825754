// Measures the cost of a union of boxes: an L, three quarters of a square, and a ring, eight ninths
// of a square, in frames of 20 backward Euler steps.
//
//   first      a new outline: order of elimination and factor, then the frame
//   new        new coefficients on the same outline
//   kept       the same coefficients as in the frame before
//   memory     memory of the solver
//
// Medians of 5 frames in ms of processor time, one thread; from 300 nodes a side on, of 3 frames.
// In brackets: CHOLMOD's as a multiple. Run: build/release/bench/unions [SIDE ...], 101 201 401 by
// default.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "measuring.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/plate/plate_solver.hpp"
#include "pliant/region/combine.hpp"

namespace {

using namespace pliant;

constexpr int steps = 20;

template <class F>
double median_ms(int repetitions, const F& f) {
  std::vector<double> times;
  for (int k = 0; k < repetitions; ++k) {
    const double begin = processor_seconds();
    f();
    times.push_back(1e3 * (processor_seconds() - begin));
  }
  return typical(std::move(times), false);
}

// A load that decreases with the distance from a point, on one patch of boxes.
PlateProblem problem_on(int side, const std::vector<Box>& boxes) {
  const Patch patch = combine(boxes, Combine::Union).at(0).patches.at(0);
  const double h = 1.0 / (side - 1);
  const Grid grid{side, side, h, h};
  Field load = Field::Zero(grid.node_count(), 3);
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      const double distance = std::hypot(i * h - 0.2, j * h - 0.3) / 0.3;
      load.row(grid.node(i, j)).array() += 1000 * std::max(0.0, 1 - distance);
    }
  }
  return {{grid, patch.interior}, {1, 2, 1}, {40, 20}, {}, std::move(load)};
}

struct Times {
  double first, fresh, kept;
  std::size_t memory;
};

Times measure(PlateProblem problem, int repetitions, SolverChoice choice) {
  const TimeSteps frame{steps, 1.0 / 24 / steps};
  const Field zero = Field::Zero(problem.outline.grid().node_count(), 3);
  PlateState state{zero, zero};
  std::unique_ptr<PlateSolver> solver;
  const auto advance = [&] {
    state = value_or_abort(solver->advance(problem, frame, std::move(state)));
  };
  Times times{};
  times.first = median_ms(repetitions, [&] {
    solver.reset();
    solver = make_plate_solver(choice);
    advance();
  });
  times.fresh = median_ms(repetitions, [&] {
    problem.stiffness.c += 1e-6;
    advance();
  });
  times.kept = median_ms(repetitions, advance);
  times.memory = solver->memory();
  return times;
}

void measure(const char* shape, int side, const std::vector<Box>& boxes) {
  const PlateProblem problem = problem_on(side, boxes);
  const int repetitions = side < 300 ? 5 : 3;
  const Times ours = measure(problem, repetitions, SolverChoice::Supernodal);
  const Times other = is_available(SolverChoice::Cholmod)
                          ? measure(problem, repetitions, SolverChoice::Cholmod)
                          : Times{};
  fmt::print(
      "| {} | {} | {} | {:.0f} ({:.1f}) | {:.0f} ({:.1f}) | {:.0f} ({:.1f}) | {} ({:.2f}) |\n",
      side, shape, unknown_count(problem.outline), ours.first, other.first / ours.first, ours.fresh,
      other.fresh / ours.fresh, ours.kept, other.kept / ours.kept, bytes_text(ours.memory),
      static_cast<double>(other.memory) / static_cast<double>(ours.memory));
  std::fflush(stdout);
}

}  // namespace

int main(int count, char** arguments) {
  std::vector<int> sides;
  for (int k = 1; k < count; ++k) sides.push_back(std::atoi(arguments[k]));
  if (sides.empty()) sides = {101, 201, 401};
  fmt::print(
      "| side | shape | unknowns | first, ms | new, ms | kept, ms | memory |\n"
      "|---|---|---|---|---|---|---|\n");
  for (const int side : sides) {
    if (side < 20) {
      fmt::print(stderr, "unions: a side has 20 nodes or more\n");
      return 2;
    }
    const int e = side - 1;
    const int a = e / 3;
    measure("L", side, {{0, e, 0, e / 2}, {0, e / 2, 0, e}});
    measure("ring", side, {{0, e, 0, a}, {0, a, 0, e}, {e - a, e, 0, e}, {0, e, e - a, e}});
  }
  return 0;
}
