// What a union of boxes costs with the sparse direct solver: an L, three quarters of a square, of
// 51, 101, 201 and 401 nodes a side, beside the whole square, whose matrix is that of a rectangle.
//
//   first      find the order of elimination and factor, as for every new outline
//   set-up     factor for new coefficients, the order kept
//   step       one solve of three right-hand sides; backward Euler does one a step
//   memory     what the solver holds
//
// The table has the medians of 5. Run: build/release/bench/unions

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <vector>

#include <fmt/format.h>

#include "pliant/plate/linear_solver.hpp"
#include "pliant/region/combine.hpp"

namespace {

using namespace pliant;

constexpr int repetitions = 5;

void check(bool is_good) {
  if (is_good) return;
  fmt::print(stderr, "unions: the solver failed\n");
  std::exit(1);
}

template <class F>
double median_ms(const F& f) {
  std::vector<double> times;
  for (int k = 0; k < repetitions; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    f(k);
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - begin;
    times.push_back(time.count());
  }
  std::sort(times.begin(), times.end());
  return times[repetitions / 2];
}

void measure(const char* shape, int side, const std::vector<Box>& boxes) {
  const Patch patch = patches_of(combine(boxes, Combine::Union).at(0)).at(0);
  const double dt = 1.0 / 24 / 20;
  PlateSystem system{{side, side, 1.0 / (side - 1), 1.0 / (side - 1)},
                     {1, 2, 1},
                     (40 / dt + 20) / dt,
                     patch.interior};
  const double first = median_ms([&](int) { check(make_solver()->factor(system).has_value()); });
  const auto solver = make_solver();
  check(solver->factor(system).has_value());
  const double set_up = median_ms([&](int k) {
    system.stiffness.c = 2 + 1e-6 * (k + 1);
    check(solver->factor(system).has_value());
  });
  const Field load = Field::Constant(patch.interior_count(), 3, 10);
  const double step = median_ms([&](int) { check(solver->solve(load).has_value()); });
  fmt::print("{:>6} {:>8} {:>10} {:>10.2f} {:>10.2f} {:>10.3f} {:>12}\n", side, shape,
             patch.interior_count(), first, set_up, step, bytes_text(solver->memory()));
}

}  // namespace

int main() {
  fmt::print("{:>6} {:>8} {:>10} {:>10} {:>10} {:>10} {:>12}\n", "side", "shape", "unknowns",
             "first, ms", "set-up, ms", "step, ms", "memory");
  for (const int side : {51, 101, 201, 401}) {
    const int last = side - 1;
    measure("L", side, {{0, last, 0, last / 2}, {0, last / 2, 0, last}});
    measure("square", side, {{0, last, 0, last}});
  }
  return 0;
}
