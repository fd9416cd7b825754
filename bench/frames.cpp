// What a frame costs, and where: sheets of 51, 101, 201 and 401 vertices per side, all of each in
// the region. A frame is 20 backward Euler steps.
//
//   set-up     factor the plate's matrix for new coefficients, the order of elimination kept
//   step       one of the 20 steps with the factor kept: right-hand side, solve, new state
//   rest       of a frame: distances, region and load, displacement in, new positions out
//   frame      20 steps and the rest, coefficients unchanged; frames/s is its inverse
//   triad      the yardstick in the same run: a[k] = b[k] + 3 c[k] over 15 doubles a node, which is
//              what a step moves at least
//
// The table at the end has the medians, and in brackets multiples of the triad, so that it can be
// compared between machines and between noisy moments of one.
// Run: build/release/bench/frames [--benchmark_min_time=SECONDS]

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "pliant/body/body.hpp"
#include "pliant/mesh/grid_mapping.hpp"
#include "pliant/mesh/grid_sheet.hpp"
#include "pliant/plate/backward_euler.hpp"

namespace {

using namespace pliant;

constexpr int steps_per_frame = 20;
constexpr double frame_length = 1.0 / 24;

struct Sheet {
  Grid grid;
  Field rest;
};

Sheet make_sheet(int side) {
  const auto mapping =
      find_grid(make_mesh({.columns = side, .rows = side, .width = 20, .depth = 20}));
  return {mapping->grid, mapping->rest};
}

BodyInputs make_inputs() {
  BodyInputs inputs;
  inputs.dynamics = {40, 20};
  inputs.frame_length = frame_length;
  inputs.dt = frame_length / steps_per_frame;
  // Reaches past every corner; a force in the middle and one aside.
  inputs.forces = {{PointForce{{0, 0, 0}, {0, 1, 0}}, 500, 100, 4, Falloff::Smooth},
                   {RadialForce{{4, -1, 3}}, 300, 3, 3, Falloff::Gaussian}};
  return inputs;
}

PlateSystem make_system(const Grid& grid) {
  const double dt = frame_length / steps_per_frame;
  return {grid, {1, 2, 1}, (40 / dt + 20) / dt};
}

void triad(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(5 * state.range(0) * state.range(0));
  std::vector<double> a(count, 0), b(count, 1), c(count, 2);
  for (auto _ : state) {
    for (std::size_t k = 0; k < count; ++k) a[k] = b[k] + 3 * c[k];
    benchmark::DoNotOptimize(a.data());
    benchmark::ClobberMemory();
  }
}

void set_up(benchmark::State& state) {
  const auto solver = make_solver();
  PlateSystem system = make_system(make_sheet(static_cast<int>(state.range(0))).grid);
  benchmark::DoNotOptimize(solver->factor(system));  // finds the order, which is kept
  for (auto _ : state) {
    system.stiffness.c += 1e-6;  // other coefficients each time
    benchmark::DoNotOptimize(solver->factor(system));
  }
}

void step(benchmark::State& state) {
  const Sheet sheet = make_sheet(static_cast<int>(state.range(0)));
  const auto solver = make_solver();
  const double dt = frame_length / steps_per_frame;
  const PlateProblem problem{
      sheet.grid, {1, 2, 1}, {40, 20}, {}, Field::Constant(sheet.grid.node_count(), 3, 10)};
  benchmark::DoNotOptimize(solver->factor(make_system(sheet.grid)));
  PlateState plate{Field::Zero(sheet.grid.node_count(), 3),
                   Field::Zero(sheet.grid.node_count(), 3)};
  for (auto _ : state) {
    plate =
        advance_backward_euler(*solver, problem, {steps_per_frame, dt}, std::move(plate)).value();
  }
}

void frame(benchmark::State& state) {
  const Sheet sheet = make_sheet(static_cast<int>(state.range(0)));
  Body body(sheet.grid, sheet.rest, {.measure = Measure::Rest});
  const BodyInputs inputs = make_inputs();
  benchmark::DoNotOptimize(body.step(inputs));  // factors; the frames below keep that
  for (auto _ : state) benchmark::DoNotOptimize(body.step(inputs));
  state.counters["frames/s"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

void rest_of_frame(benchmark::State& state) {
  const Sheet sheet = make_sheet(static_cast<int>(state.range(0)));
  const BodyInputs inputs = make_inputs();
  for (auto _ : state) {
    const Field nodes = to_world(inputs.transform, sheet.rest);
    const Selection selection = select_region(sheet.grid, nodes, inputs.forces);
    const Field load = vectors_to_object(
        inputs.transform, assemble_load(sheet.grid, nodes, inputs.forces, selection));
    const Field displacement = nodes - sheet.rest;
    const Field moved = sheet.rest + displacement;
    benchmark::DoNotOptimize(load.data());
    benchmark::DoNotOptimize(moved.data());
  }
}

// Shows every line as usual and keeps the medians.
class Medians : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs) {
      if (run.aggregate_name == "median") {
        seconds_[run.run_name.function_name + "/" + run.run_name.args] =
            run.GetAdjustedRealTime() * 1e-3;
      }
    }
  }

  double milliseconds(std::string_view name, int side) const {
    const auto found = seconds_.find(fmt::format("{}/{}", name, side));
    return found == seconds_.end() ? 0 : found->second * 1e3;
  }

 private:
  std::map<std::string, double> seconds_;
};

void print_table(const Medians& medians, const std::vector<int>& sides) {
  fmt::print("\nmedians in ms, and in brackets as multiples of the triad of the same size\n");
  fmt::print("{:>6} {:>10} {:>20} {:>20} {:>20} {:>20} {:>10}\n", "side", "triad", "set-up", "step",
             "rest", "frame", "frames/s");
  for (const int side : sides) {
    const double triad_ms = medians.milliseconds("triad", side);
    if (triad_ms == 0) continue;
    const double step_ms = medians.milliseconds("step", side) / steps_per_frame;
    const double frame_ms = medians.milliseconds("frame", side);
    const auto cell = [&](double ms) { return fmt::format("{:.3f} ({:.1f})", ms, ms / triad_ms); };
    fmt::print("{:>6} {:>10.4f} {:>20} {:>20} {:>20} {:>20} {:>10.1f}\n", side, triad_ms,
               cell(medians.milliseconds("set_up", side)), cell(step_ms),
               cell(medians.milliseconds("rest_of_frame", side)), cell(frame_ms), 1e3 / frame_ms);
  }
}

}  // namespace

int main(int count, char* arguments[]) {
  const std::vector<int> sides{51, 101, 201, 401};
  for (const auto& [name, function] : {std::pair{"triad", &triad},
                                       {"set_up", &set_up},
                                       {"step", &step},
                                       {"rest_of_frame", &rest_of_frame},
                                       {"frame", &frame}}) {
    auto* registered = benchmark::RegisterBenchmark(name, function);
    for (const int side : sides) registered->Arg(side);
    registered->Unit(benchmark::kMillisecond)->Repetitions(5)->ReportAggregatesOnly();
  }
  benchmark::Initialize(&count, arguments);
  if (benchmark::ReportUnrecognizedArguments(count, arguments)) return 1;
  Medians medians;
  benchmark::RunSpecifiedBenchmarks(&medians);
  print_table(medians, sides);
  return 0;
}
