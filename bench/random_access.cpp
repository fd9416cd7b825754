// Measures the cost of a frame requested out of order after a run was played: square sheets, every
// vertex in the region, 20 backward Euler steps per frame, 240 frames.
//
//   room       number of states that fit in the memory for kept states
//   interval   frames from one checkpoint to the next: the least power of two for which the
//              checkpoints use half of the room
//   played     a frame when playing forwards, on average [ms]
//   random     a random frame, on average and at most [ms]
//   share      the same, in units of the time for playing one interval
//   solved     frames solved for a random frame, on average and at most, in intervals
//   backwards  a frame when playing backwards, on average [ms]
//
// Run: build/release/bench/random_access [--sides 51,101,...] [--room MIB] [--count N]

#include <algorithm>
#include <cstdlib>
#include <random>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "measuring.hpp"
#include "pliant/pliant.hpp"

namespace {

using namespace pliant;

constexpr int frame_count = 240;

struct Options {
  std::vector<int> sides = {51, 201, 481};
  std::size_t room = 256;  // [MiB]
  int count = 100;         // of frames at random
};

Scene make_scene(int side) {
  Scene scene;
  scene.end = frame_count;
  Surface sheet;
  sheet.name = "sheet";
  sheet.shape = GridSheet{.columns = side, .rows = side, .width = 20, .depth = 20};
  sheet.material.density = 40.0;
  sheet.material.damping = 20.0;
  sheet.solver.dt = 1 / scene.fps / 20;
  sheet.solver.measure = Measure::Rest;  // the region stays the whole sheet
  scene.surfaces.push_back(std::move(sheet));
  Force force;
  force.name = "middle";
  force.kind = PointChannels{.center = Value<3>{0, 0, 0}};
  force.magnitude = 500.0;
  force.deformation_radius = 100.0;
  force.force_radius = 4.0;
  scene.forces.push_back(std::move(force));
  return scene;
}

void show(Simulation& simulation, int frame) {
  if (!simulation.at(frame)) std::abort();
}

struct Costs {
  double sum = 0;
  double most = 0;
  void add(double cost) {
    sum += cost;
    most = std::max(most, cost);
  }
};

void measure(int side, const Options& options) {
  const std::size_t bytes = options.room << 20;
  auto simulation = Simulation::make(make_scene(side), {.checkpoint_bytes = bytes}).value();
  const std::size_t room = bytes / (static_cast<std::size_t>(side) * side * 6 * sizeof(double));
  int interval = 1;
  if (frame_count - 1 > static_cast<int>(room)) {
    while ((frame_count - 1) / interval > std::max(1, static_cast<int>(room) / 2)) interval *= 2;
  }
  const double played = seconds([&] {
    for (const int frame : simulation.frames()) show(simulation, frame);
  });
  const double of_frame = played / frame_count;

  std::mt19937 random(1);
  Costs time, solved;
  for (int n = 0; n < options.count; ++n) {
    const int frame = std::uniform_int_distribution(1, frame_count)(random);
    const int before = simulation.frame_counts().solved;
    time.add(seconds([&] { show(simulation, frame); }));
    solved.add(simulation.frame_counts().solved - before);
  }
  const double backwards = seconds([&] {
    for (int frame = frame_count; frame >= 1; --frame) show(simulation, frame);
  });
  const double of_interval = of_frame * interval;
  fmt::print(
      "{:>5} {:>5} {:>8} {:>8.2f} {:>8.2f} {:>8.2f} {:>6.2f} {:>6.2f} {:>6.2f} {:>6.2f} "
      "{:>9.2f}\n",
      side, room, interval, 1e3 * of_frame, 1e3 * time.sum / options.count, 1e3 * time.most,
      time.sum / options.count / of_interval, time.most / of_interval,
      solved.sum / options.count / interval, solved.most / interval, 1e3 * backwards / frame_count);
}

}  // namespace

int main(int count, char* arguments[]) {
  Options options;
  if (!read_options(
          count, arguments,
          {{"--sides", &options.sides}, {"--room", &options.room}, {"--count", &options.count}},
          "random_access [--sides 51,101,...] [--room MIB] [--count N]"))
    return 2;
  fmt::print("{:>5} {:>5} {:>8} {:>8} {:>17} {:>13} {:>13} {:>9}\n", "side", "room", "interval",
             "played", "random", "share", "solved", "backwards");
  for (const int side : options.sides) measure(side, options);
  return 0;
}
