// What a frame costs from the forces to the new positions: sheets of 51 to 1001 vertices per side,
// all of each in the region. A frame is 20 backward Euler steps, by the solver that a run takes;
// bench/plate tells what becomes of them.
//
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

void triad(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(5 * state.range(0) * state.range(0));
  std::vector<double> a(count, 0), b(count, 1), c(count, 2);
  for (auto _ : state) {
    for (std::size_t k = 0; k < count; ++k) a[k] = b[k] + 3 * c[k];
    benchmark::DoNotOptimize(a.data());
    benchmark::ClobberMemory();
  }
}

void frame(benchmark::State& state) {
  const Sheet sheet = make_sheet(static_cast<int>(state.range(0)));
  Body body(sheet.grid, sheet.rest, {.measure = Measure::Rest});
  const BodyInputs inputs = make_inputs();
  benchmark::DoNotOptimize(body.step(inputs));  // sets the solver up; the frames below keep that
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
  fmt::print("{:>6} {:>10} {:>20} {:>20} {:>10}\n", "side", "triad", "rest", "frame", "frames/s");
  for (const int side : sides) {
    const double triad_ms = medians.milliseconds("triad", side);
    if (triad_ms == 0) continue;
    const double frame_ms = medians.milliseconds("frame", side);
    const auto cell = [&](double ms) { return fmt::format("{:.3f} ({:.1f})", ms, ms / triad_ms); };
    fmt::print("{:>6} {:>10.4f} {:>20} {:>20} {:>10.1f}\n", side, triad_ms,
               cell(medians.milliseconds("rest_of_frame", side)), cell(frame_ms), 1e3 / frame_ms);
  }
}

}  // namespace

int main(int count, char* arguments[]) {
  const std::vector<int> sides{51, 101, 201, 401, 481, 1001};
  for (const auto& [name, function] :
       {std::pair{"triad", &triad}, {"rest_of_frame", &rest_of_frame}, {"frame", &frame}}) {
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
