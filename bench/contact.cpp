// Measures what contact costs: a clamped square sheet of which the whole is solved, against a frame
// of the same sheet that meets nothing, in the same run. Frames are of 5 steps, in one thread.
//
//   free   a frame of a sheet that no collider targets, the median [ms]
//   near   a ball passes near it and touches nothing
//   others a ball or a floor touches it and moves on in each frame; the nodes that it pushes in the
//          last frame, and the median; first: the frame in which it meets the sheet
//
// Times are those of the processor; in brackets as a part of the free one.
// Run: build/release/bench/contact [--sides 101,201] [--frames N]

#include <algorithm>
#include <cstdio>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "measuring.hpp"
#include "pliant/body/grid_body.hpp"

namespace {

using namespace pliant;

constexpr double frame_length = 1.0 / 24;

Field sheet(const Grid& grid) {
  Field rest(grid.node_count(), 3);
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i)
      rest.row(grid.node(i, j)) << i * grid.hu - 0.5, 0, j * grid.hv - 0.5;
  }
  return rest;
}

struct Case {
  std::string_view name;
  Solid shape = SphereSolid{0.1};
  bool has_collider = true;
  double first = 0, last = 0;  // height of its centre, or of the floor, at the first and last frame
  double load = 0;             // down, on all of the sheet
  double density = 1;
};

struct Outcome {
  std::vector<double> times;  // [s]
  int pushed = 0;
};

Outcome run(const Case& of, const Grid& grid, int frames) {
  BodySettings settings;
  settings.region = SolvedRegion::All;
  GridBody body(grid, sheet(grid), settings);
  Outcome outcome;
  for (int frame = 0; frame < frames; ++frame) {
    BodyInputs inputs;
    inputs.dynamics = {of.density, of.density};
    inputs.frame_length = frame_length;
    inputs.dt = frame_length / 5;
    if (of.load != 0) {
      inputs.forces.push_back({.kind = UniformForce{{0, -1, 0}},
                               .magnitude = of.load,
                               .deformation_radius = 0,
                               .force_radius = 10});
    }
    const auto pose = [&](int at) {
      const double height = of.first + (of.last - of.first) * at / frames;
      return ColliderPose{of.shape, {{0.02 * at / frames, height, 0.01}}, 0};
    };
    if (of.has_collider) {
      inputs.colliders.push_back({pose(frame), pose(frame + 1), 0});
      inputs.motion = BodyMotion{};
    }
    const double begin = processor_seconds();
    const auto stepped = body.step(inputs);
    outcome.times.push_back(processor_seconds() - begin);
    if (!stepped) {
      fmt::print(stderr, "{}\n", stepped.error().message);
      std::exit(1);
    }
  }
  for (const ContactFacts& facts : body.state().contacts)
    outcome.pushed += static_cast<int>(facts.nodes.size());
  return outcome;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<int> sides = {101, 201};
  int frames = 25;
  if (!read_options(argc, argv, {{"--sides", &sides}, {"--frames", &frames}},
                    "contact [--sides 101,201] [--frames N]")) {
    return 2;
  }
  for (const int side : sides) {
    const Grid grid{side, side, 1.0 / (side - 1), 1.0 / (side - 1)};
    const std::vector<Case> cases = {
        {.name = "free", .has_collider = false, .load = 30},
        {.name = "near", .first = 0.2, .last = 0.15, .load = 0.1},
        {.name = "ball", .first = 0.12, .last = 0.02},
        {.name = "light ball", .first = 0.12, .last = 0.02, .density = 40},
        {.name = "floor", .shape = PlaneSolid{}, .first = -0.002, .last = -0.002, .load = 2000},
        {.name = "wide floor",
         .shape = PlaneSolid{},
         .first = -0.002,
         .last = -0.002,
         .load = 40000},
    };
    double free_time = 0;
    for (const Case& one : cases) {
      Outcome outcome = run(one, grid, frames);
      const double most = *std::max_element(outcome.times.begin(), outcome.times.end());
      const double time = typical(outcome.times, false);
      if (one.name == "free") free_time = time;
      fmt::print("{:4} {:12} {:8.2f} ms ({:6.1f}), most {:8.1f} ms, pushes {}\n", side, one.name,
                 time * 1e3, time / free_time, most * 1e3, outcome.pushed);
      std::fflush(stdout);
    }
  }
  return 0;
}
