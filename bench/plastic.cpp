// Measures what plasticity costs: a clamped square plate that a keyed push bends further in each
// frame, while a part of its nodes flows, against the same plate without a law in the same run.
// Frames are those of a scene's defaults, 24 a second in steps of at most 0.01 s.
//
//   flow     the nodes that flow in a frame, as a part of all, the mean over the frames measured
//   elastic  a frame of the elastic plate, the median [ms]
//   watched  a frame of a plate that could yield and does not, in such frames
//   plastic  a frame in which nodes flow
//   solves   in such a frame
//
// Times are those of the processor, in one thread; in brackets as a part of the elastic one.
// Run: build/release/bench/plastic [--sides 101,201] [--frames N] [--flow PART] [--hardening H]
//      [--components 1..3] [--newmark]

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
  std::vector<int> sides = {101, 201};
  int frames = 48;
  double hardening = 0.1;
  Integrator integrator = Integrator::BackwardEuler;
  int components = 1;
  double flow = 0;  // 0: a tenth, and almost all
};

constexpr double frame_length = 1.0 / 24;
constexpr int first_measured = 12;

Field pushed(const Grid& grid, int components) {
  Field load = Field::Zero(grid.node_count(), 3);
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) {
      const double u = i * grid.hu, v = j * grid.hv;
      const double distance = std::sqrt((u - 0.42) * (u - 0.42) + (v - 0.55) * (v - 0.55));
      if (distance >= 0.25) continue;
      const double part = 1 - distance / 0.25;
      const double push = part * part * (3 - 2 * part);
      load(grid.node(i, j), 1) = push;
      if (components > 1) load(grid.node(i, j), 0) = 0.4 * push;
      if (components > 2) load(grid.node(i, j), 2) = -0.2 * push * (u - 0.3);
    }
  }
  return load;
}

struct Outcome {
  std::vector<double> times;  // [s]
  double flow = 0, solves = 0;
  Field displacement;
};

Outcome run(const Options& options, const Grid& grid, double yield) {
  const Field push = pushed(grid, options.components);
  const TimeSteps steps = [&] {
    TimeSteps all = divide_interval(frame_length, 0.01, Stepping::Exact);
    all.integrator = options.integrator;
    return all;
  }();
  const auto solver = make_plate_solver();
  const int nodes = grid.node_count();
  PlateState state{Field::Zero(nodes, 3), Field::Zero(nodes, 3), {}};
  PlateProblem problem{grid, {}, {1, 1}, {}, {}};
  if (yield > 0) {
    problem.law = PlasticLaw{yield, options.hardening};
    state.plastic = PlasticField::Zero(nodes, 9);
  }
  Outcome outcome;
  for (int frame = 1; frame <= options.frames; ++frame) {
    problem.load = frame / 24.0 * push;
    const PlasticField before = state.plastic;
    const auto solves = solver->counts().solves;
    const double begin = processor_seconds();
    state = solver->advance(problem, steps, std::move(state)).value();
    const double time = processor_seconds() - begin;
    if (frame <= first_measured) continue;
    outcome.times.push_back(time);
    outcome.solves += static_cast<double>(solver->counts().solves - solves);
    for (int k = 0; yield > 0 && k < nodes; ++k) {
      outcome.flow += state.plastic.row(k) != before.row(k) ? 1.0 / nodes : 0;
    }
  }
  outcome.solves /= options.frames - first_measured;
  outcome.flow /= options.frames - first_measured;
  outcome.displacement = state.displacement;
  return outcome;
}

// The yield stress at which such a part of the nodes flows.
double yield_for(const Options& options, const Grid& grid, double part) {
  double low = 1e-6, high = 1;
  for (int k = 0; k < 14; ++k) {
    const double middle = std::sqrt(low * high);
    (run(options, grid, middle).flow > part ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

void measure(const Options& options, int side, double part) {
  const Grid grid{side, side, 1.0 / (side - 1), 1.0 / (side - 1)};
  // The part hardly depends on how fine the plate is.
  const Grid rough{51, 51, 1.0 / 50, 1.0 / 50};
  const double yield = yield_for(options, rough, part);
  const double elastic = typical(run(options, grid, 0).times, false);
  const double watched = typical(run(options, grid, 1e6).times, false);
  const Outcome plastic = run(options, grid, yield);
  const double frame = typical(plastic.times, false);
  fmt::print("{:5} {:7.3f} {:9.3f} {:9.3f} ({:5.2f}) {:9.3f} ({:6.2f}) {:7.1f}\n", side,
             plastic.flow, 1e3 * elastic, 1e3 * watched, watched / elastic, 1e3 * frame,
             frame / elastic, plastic.solves);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  bool is_newmark = false;
  if (!read_options(argc, argv,
                    {{"--sides", &options.sides},
                     {"--frames", &options.frames},
                     {"--flow", &options.flow},
                     {"--hardening", &options.hardening},
                     {"--components", &options.components},
                     {"--newmark", &is_newmark}},
                    "plastic [--sides 101,201] [--frames N] [--flow PART] [--hardening H] "
                    "[--components 1..3] [--newmark]"))
    return 2;
  if (is_newmark) options.integrator = Integrator::Newmark;
  options.frames = std::max(options.frames, first_measured + 1);
  fmt::print(" side    flow   elastic   watched (ratio)   plastic (ratio)  solves\n");
  const std::vector<double> parts =
      options.flow > 0 ? std::vector{options.flow} : std::vector{0.1, 0.97};
  for (const double part : parts) {
    for (const int side : options.sides) measure(options, side, part);
  }
}
