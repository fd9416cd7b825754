// Measures what the exact integrator costs and how right it is: a clamped square plate without
// damping, pushed along one axis in a part of it, by a load that is keyed from 0 to its full size
// in 24 frames, or is there at once.
//
//   rad      of the first mode in a frame
//   solves   in a frame, the mean over all; a complex one counts as two
//   frame    quickest of the frames after the 24th [ms]; in brackets the mean of all
//   steps    that time in steps of backward Euler, each measured in a frame of 40
//   error    the largest difference from steps of half the length, as a part of the largest
//            displacement
//
// Run: build/release/bench/integrators [--side N] [--frames N] [--factors]

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "measuring.hpp"
#include "pliant/plate/plate_solver.hpp"

namespace {

using namespace pliant;

struct Options {
  int side = 201;
  int frames = 250;
  SolverChoice solver = SolverChoice::Auto;
};

constexpr int rise = 24;

Field pushed(const Grid& grid) {
  Field load = Field::Zero(grid.node_count(), 3);
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) {
      const double u = i * grid.hu, v = j * grid.hv;
      if (std::abs(u - 0.42) < 0.2 && std::abs(v - 0.55) < 0.15) load(grid.node(i, j), 1) = 1;
    }
  }
  return load;
}

PlateState at_rest(const Grid& grid) {
  return {Field::Zero(grid.node_count(), 3), Field::Zero(grid.node_count(), 3)};
}

// A step of backward Euler. [s]
double step_seconds(const Options& options, const Grid& grid, const Field& load, double interval) {
  constexpr int steps = 40;
  const auto solver = make_plate_solver(options.solver);
  const PlateProblem problem{grid, {}, {1, 0}, {}, load};
  PlateState state = at_rest(grid);
  std::vector<double> times;
  for (int frame = 0; frame < 12; ++frame) {
    times.push_back(
        seconds([&] {
          state = solver->advance(problem, {steps, interval / steps}, std::move(state)).value();
        }) /
        steps);
  }
  return typical(std::move(times), true);
}

struct Outcome {
  std::vector<Field> displacements;
  std::vector<double> times;  // [s]
  double solves = 0;          // in a frame
};

Outcome run(const Options& options, const Grid& grid, const Field& load, double interval,
            bool is_keyed, int parts) {
  const auto solver = make_plate_solver(options.solver);
  PlateState state = at_rest(grid);
  Outcome outcome;
  const auto part = [&](int frame) { return is_keyed ? std::min(1.0, frame / double{rise}) : 1.0; };
  for (int frame = 0; frame < options.frames; ++frame) {
    PlateProblem problem{grid, {}, {1, 0}, {}, part(frame) * load};
    problem.first_load = part(std::max(0, frame - 1)) * load;
    const TimeSteps steps{parts, interval, Integrator::Exact};
    outcome.times.push_back(
        seconds([&] { state = solver->advance(problem, steps, std::move(state)).value(); }));
    outcome.displacements.push_back(state.displacement);
  }
  outcome.solves = static_cast<double>(solver->counts().solves) / options.frames;
  return outcome;
}

void measure(const Options& options, double angle, bool is_keyed) {
  const Grid grid{options.side, options.side, 1.0 / (options.side - 1), 1.0 / (options.side - 1)};
  const Field load = pushed(grid);
  constexpr double first_mode = 35.985;  // as the side grows
  const double interval = angle / first_mode;
  const double step = step_seconds(options, grid, load, interval);
  const Outcome whole = run(options, grid, load, interval, is_keyed, 1);
  const Outcome halved = run(options, grid, load, interval, is_keyed, 2);
  double peak = 0, error = 0, sum = 0;
  for (std::size_t k = 0; k < whole.times.size(); ++k) {
    peak = std::max(peak, whole.displacements[k].cwiseAbs().maxCoeff());
    error =
        std::max(error, (whole.displacements[k] - halved.displacements[k]).cwiseAbs().maxCoeff());
    sum += whole.times[k];
  }
  const double frame =
      typical({whole.times.begin() + std::min(rise, options.frames - 1), whole.times.end()}, true);
  const double mean = sum / options.frames;
  fmt::print("{:5} {:>6} {:7.1f} {:8.2f} ({:8.2f}) {:7.1f} ({:7.1f}) {:9.1e}\n", angle,
             is_keyed ? "keyed" : "jump", whole.solves, 1e3 * frame, 1e3 * mean, frame / step,
             mean / step, error / peak);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  bool has_factors = false;
  const bool are_right = read_options(
      argc, argv,
      {{"--side", &options.side}, {"--frames", &options.frames}, {"--factors", &has_factors}},
      "integrators [--side N] [--frames N] [--factors]");
  if (!are_right || options.side < 5 || options.frames < 2) return 2;
  if (has_factors) options.solver = available_solvers().front();
  fmt::print("{} x {} nodes, {} frames\n", options.side, options.side, options.frames);
  fmt::print("  rad   load  solves    frame        (ms)   steps   (mean)     error\n");
  for (const double angle : {0.1, 0.25, 0.5, 1.0, 2.0, 5.0}) measure(options, angle, true);
  for (const double angle : {0.1, 0.5, 2.0}) measure(options, angle, false);
}
