// Measures what contact costs: a clamped square sheet of which the whole is solved, against a frame
// of the same sheet that meets nothing, in the same run. Frames are of 5 steps, in one thread.
//
//   free   a frame of a sheet that no collider targets, the median [ms]
//   near   a ball passes near it and touches nothing
//   mesh   the same with a mesh of 10^5 triangles; one that a cache moves is "cached", and one that
//          encloses all of the sheet, with a hollow, is "around"
//   rows   a force that moves on presses it on a floor, which pushes so many nodes or nearly
//   others a ball or a floor touches it and moves on in each frame; the nodes that it pushes in the
//          last frame, and the median; first: the frame in which it meets the sheet
//
// Times are those of the processor; in brackets as a part of the free one.
// Run: build/release/bench/contact [--sides 101,201] [--frames N] [--only PART_OF_A_NAME]

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
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

// A ball of triangles, in rows from pole to pole, which are not where a sheet meets it;
// `is_around`: with a hollow within.
MeshSolid mesh_of_ball(double radius, int rows, bool is_around) {
  constexpr double half_turn = 3.14159265358979323846;
  const int columns = rows;
  std::vector<Vector3d> places;
  std::vector<SolidMesh::Corners> triangles;
  const auto add_ball = [&](double size, bool is_inward) {
    const int first = static_cast<int>(places.size());
    places.emplace_back(size, 0, 0);
    places.emplace_back(-size, 0, 0);
    for (int row = 1; row < rows; ++row) {
      for (int k = 0; k < columns; ++k) {
        const double down = half_turn * row / rows, round = 2 * half_turn * k / columns;
        places.emplace_back(size * std::cos(down), size * std::sin(down) * std::cos(round),
                            size * std::sin(down) * std::sin(round));
      }
    }
    const auto at = [&](int row, int k) {
      if (row == 0 || row == rows) return first + (row == 0 ? 0 : 1);
      return first + 2 + (row - 1) * columns + k % columns;
    };
    const auto add = [&](int a, int b, int c) {
      if (a == b || b == c || c == a) return;
      triangles.push_back(is_inward ? SolidMesh::Corners{a, c, b} : SolidMesh::Corners{a, b, c});
    };
    for (int row = 0; row < rows; ++row) {
      for (int k = 0; k < columns; ++k) {
        add(at(row, k), at(row, k + 1), at(row + 1, k));
        add(at(row, k + 1), at(row + 1, k + 1), at(row + 1, k));
      }
    }
  };
  add_ball(radius, false);
  if (is_around) add_ball(0.9 * radius, true);
  Field points(static_cast<Eigen::Index>(places.size()), 3);
  for (std::size_t k = 0; k < places.size(); ++k)
    points.row(static_cast<Eigen::Index>(k)) = places[k].transpose();
  if (SolidMesh::open_edge(triangles)) std::abort();
  return {std::make_shared<const PosedMesh>(SolidMesh::make(triangles, points).value(), points)};
}

struct Case {
  std::string_view name;
  Solid shape = SphereSolid{0.1};
  bool has_collider = true;
  double first = 0, last = 0;  // height of its centre, or of the floor, at the first and last frame
  double load = 0;             // down
  double radius = 0;           // within which it presses, moving on; 0: on all of the sheet
  double density = 1;
  bool is_cached = false;  // each frame has a mesh of its own
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
    if (of.radius != 0) {
      inputs.forces.push_back({.kind = PointForce{{0.02 * frame / frames, 0, 0.01}, {0, -1, 0}},
                               .magnitude = of.load,
                               .deformation_radius = 0,
                               .force_radius = of.radius});
    } else if (of.load != 0) {
      inputs.forces.push_back({.kind = UniformForce{{0, -1, 0}},
                               .magnitude = of.load,
                               .deformation_radius = 0,
                               .force_radius = 10});
    }
    const auto pose = [&](int at) {
      const double height = of.first + (of.last - of.first) * at / frames;
      return ColliderPose{of.shape, {{0.02 * at / frames, height, 0.01}}, 0};
    };
    const auto other_mesh = [&](ColliderPose pose) {
      const PosedMesh& mesh = *std::get<MeshSolid>(pose.shape).posed;
      pose.shape = MeshSolid{std::make_shared<const PosedMesh>(mesh.shared_mesh(),
                                                               (1 + 1e-3 * frame) * mesh.points())};
      return pose;
    };
    if (of.has_collider) {
      inputs.colliders.push_back(
          {pose(frame), of.is_cached ? other_mesh(pose(frame + 1)) : pose(frame + 1), 0});
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
  std::string only;
  if (!read_options(argc, argv, {{"--sides", &sides}, {"--frames", &frames}, {"--only", &only}},
                    "contact [--sides 101,201] [--frames N] [--only PART_OF_A_NAME]")) {
    return 2;
  }
  const MeshSolid hill = mesh_of_ball(5, 224, false);
  const MeshSolid mesh = mesh_of_ball(0.1, 224, false), around = mesh_of_ball(1, 158, true);
  for (const int side : sides) {
    const Grid grid{side, side, 1.0 / (side - 1), 1.0 / (side - 1)};
    // Within so many nodes around.
    const auto pressed = [&](std::string_view name, double nodes) {
      return Case{.name = name,
                  .shape = PlaneSolid{},
                  .first = -0.002,
                  .last = -0.002,
                  .load = 20000,
                  .radius = nodes * grid.hu};
    };
    const std::vector<Case> cases = {
        {.name = "free", .has_collider = false, .load = 30},
        {.name = "near", .first = 0.2, .last = 0.15, .load = 0.1},
        {.name = "near mesh", .shape = mesh, .first = 0.2, .last = 0.15, .load = 0.1},
        {.name = "near cached",
         .shape = mesh,
         .first = 0.2,
         .last = 0.15,
         .load = 0.1,
         .is_cached = true},
        {.name = "around mesh", .shape = around, .load = 0.1},
        {.name = "mesh ball", .shape = mesh, .first = 0.12, .last = 0.02},
        {.name = "cached ball", .shape = mesh, .first = 0.12, .last = 0.02, .is_cached = true},
        {.name = "ball", .first = 0.12, .last = 0.02},
        pressed("50 rows", 3.6),
        pressed("500 rows", 11.5),
        pressed("5000 rows", 36),
        {.name = "light ball", .first = 0.12, .last = 0.02, .density = 40},
        {.name = "heavy sheet",
         .shape = SphereSolid{0.3},
         .first = 0.32,
         .last = 0.25,
         .density = 1000},
        {.name = "floor", .shape = PlaneSolid{}, .first = -0.002, .last = -0.002, .load = 2000},
        {.name = "mesh floor", .shape = hill, .first = -5.002, .last = -5.002, .load = 2000},
        {.name = "ball floor",
         .shape = SphereSolid{5},
         .first = -5.002,
         .last = -5.002,
         .load = 2000},
        {.name = "wide floor",
         .shape = PlaneSolid{},
         .first = -0.002,
         .last = -0.002,
         .load = 40000},
    };
    double free_time = 0;
    for (const Case& one : cases) {
      if (one.has_collider && one.name.find(only) == std::string_view::npos) continue;
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
