// Measures the cost of a union of boxes, solved by overlapping rectangles in sine space and by a
// sparse factor: an L, three quarters of a square, and a ring, eight ninths of a square, in frames
// of 20 backward Euler steps.
//
//   first      a new outline: cover and tables, or order of elimination and factor, then the frame
//   new        new coefficients on the same outline
//   kept       the same coefficients as in the frame before
//   rounds     rounds over the rectangles, per step of `kept`
//   memory     memory of the solver
//
// Medians of 5 frames in ms of processor time, one thread; from 300 nodes a side on, of 3 frames,
// and of 1 with factors. In brackets: the time with a factor as a multiple. Run:
// build/release/bench/unions [SIDE ...], 101 201 401 by default.

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
#include "pliant/plate/solver_factories.hpp"
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
  double first, fresh, kept, rounds;
  std::size_t memory;
};

template <class Make>
Times measure(PlateProblem problem, int repetitions, const Make& make) {
  const TimeSteps frame{steps, 1.0 / 24 / steps};
  const Field zero = Field::Zero(problem.outline.grid().node_count(), 3);
  PlateState state{zero, zero};
  long asked = 0;
  const RunContext context{.should_stop = [&] {
    ++asked;
    return false;
  }};
  std::unique_ptr<PlateSolver> solver;
  const auto advance = [&] {
    state = value_or_abort(solver->advance(problem, frame, std::move(state)));
  };
  Times times{};
  times.first = median_ms(repetitions, [&] {
    solver.reset();
    solver = make(context);
    advance();
  });
  times.fresh = median_ms(repetitions, [&] {
    problem.stiffness.c += 1e-6;
    advance();
  });
  asked = 0;
  times.kept = median_ms(repetitions, advance);
  times.rounds = static_cast<double>(asked) / repetitions / steps;
  times.memory = solver->memory();
  return times;
}

void measure(const char* shape, int side, const std::vector<Box>& boxes) {
  const PlateProblem problem = problem_on(side, boxes);
  const bool is_small = side < 300;
  const Times ours = measure(problem, is_small ? 5 : 3, [](const RunContext& context) {
    return make_schwarz_solver(context);
  });
  const SolverChoice choice =
      is_available(SolverChoice::Cholmod) ? SolverChoice::Supernodal : SolverChoice::Eigen;
  const Times direct = measure(problem, is_small ? 5 : 1, [&](const RunContext& context) {
    return make_plate_solver(choice, context);
  });
  fmt::print(
      "| {} | {} | {} | {:.0f} ({:.2f}) | {:.0f} ({:.2f}) | {:.0f} ({:.2f}) | {:.1f} | {} | {} |\n",
      side, shape, unknown_count(problem.outline), ours.first, direct.first / ours.first,
      ours.fresh, direct.fresh / ours.fresh, ours.kept, direct.kept / ours.kept, ours.rounds,
      bytes_text(ours.memory), bytes_text(direct.memory));
  std::fflush(stdout);
}

}  // namespace

int main(int count, char** arguments) {
  std::vector<int> sides;
  for (int k = 1; k < count; ++k) sides.push_back(std::atoi(arguments[k]));
  if (sides.empty()) sides = {101, 201, 401};
  fmt::print(
      "| side | shape | unknowns | first, ms | new, ms | kept, ms | rounds | memory | factor |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
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
