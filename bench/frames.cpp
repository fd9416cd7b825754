// Measures the cost of a frame from the channels to the file: square sheets, every vertex in the
// region, 20 backward Euler steps per frame by the default solver; bench/plate measures these
// steps. A Simulation plays the frames; the times of the stages are from its profile.
//
//   triad      the reference in the same run: a[k] = b[k] + 3 c[k] over 15 doubles per node, the
//              least memory traffic of a step
//   solve      transforms and steps, coefficients unchanged
//   select     channels, boxes around the nodes, distances, checks for finite values
//   load       of two forces, one over a sixth of the sheet and one over a tenth
//   in, out    copies of the state to the plate and back, and checks for finite values
//   output     positions in the order of the mesh and in world space, and their peak
//   writers    one frame in each format, on a RAM disk if there is one
//   holds      whether all other stages, with the slowest writer, take less time than the solve
//
// Medians over frames, in ms; "rest" is the sum of all but the solve, "frame" that of all but the
// writers: on a noisy machine a median of sums would contain the noise. With --least the minima,
// for a shared machine: other loads only lengthen times. At the end: the cost of a selection on a
// million vertices, compared with computing every distance, that of forces along their normals,
// and that of a force that follows.
//
// Run: build/release/bench/frames [--sides 51,101,...] [--seconds S] [--threads N] [--least]

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "measuring.hpp"
#include "pliant/mesh/grid_mapping.hpp"
#include "pliant/pliant.hpp"
#include "pliant/region/region.hpp"
#include "pliant/sampling/sampling.hpp"

namespace {

using namespace pliant;

constexpr int steps_per_frame = 20;
constexpr double fps = 24;
const std::vector<std::string> endings = {"npy", "pc2", "mdd", "ply"};

struct Options {
  std::vector<int> sides = {51, 101, 201, 401, 480, 481, 1001};
  double seconds = 2;  // for each side
  int threads = 1;
  bool is_least = false;
};

Force force(std::string name, decltype(Force::kind) shape, double magnitude,
            double deformation_radius, double force_radius, Falloff falloff) {
  Force force;
  force.name = std::move(name);
  force.kind = std::move(shape);
  force.magnitude = magnitude;
  force.deformation_radius = deformation_radius;
  force.force_radius = force_radius;
  force.falloff = falloff;
  return force;
}

Scene make_scene(int side) {
  Surface sheet;
  sheet.name = "sheet";
  sheet.shape = GridSheet{.columns = side, .rows = side, .width = 20, .depth = 20};
  sheet.material.density = 40.0;
  sheet.material.damping = 20.0;
  sheet.solver.dt = 1 / fps / steps_per_frame;
  sheet.solver.measure = Measure::Rest;  // the region stays the whole sheet
  Scene scene;
  scene.fps = fps;
  scene.start = 0;
  scene.end = 50'000;
  scene.surfaces.push_back(std::move(sheet));
  // A force in the middle, whose region includes every corner, and one aside.
  scene.forces.push_back(
      force("middle", PointChannels{.center = Value<3>{0, 0, 0}}, 500, 100, 4, Falloff::Smooth));
  scene.forces.push_back(
      force("aside", RadialChannels{.center = Value<3>{4, -1, 3}}, 300, 3, 3, Falloff::Gaussian));
  return scene;
}

// Times of many frames. [s]
struct Times {
  std::vector<double> triad, solve, select, load, in, out, output;
  std::vector<std::vector<double>> writers = std::vector<std::vector<double>>(endings.size());
};

double triad(int side) {
  static std::vector<double> a, b, c;
  const auto count = static_cast<std::size_t>(5) * side * side;
  a.resize(count, 0), b.resize(count, 1), c.resize(count, 2);
  return seconds([&] {
    for (std::size_t k = 0; k < count; ++k) a[k] = b[k] + 3 * c[k];
  });
}

// Writes a frame into a file of each format. Twice, since the first write allocates the buffers.
void time_writers(const ScratchFolder& folder, const Simulation& simulation,
                  const SurfacePose& pose, Times& times) {
  const Mesh& mesh = simulation.rest_shapes()[0].mesh;
  for (std::size_t k = 0; k < endings.size(); ++k) {
    const auto writer = make_writer({.file = folder.file("a." + endings[k]),
                                     .surfaces = {{"sheet", &mesh, mesh.positions}},
                                     .first_frame = 1,
                                     .last_frame = 2,
                                     .fps = fps})
                            .value();
    double last = 0;
    for (int frame = 1; frame <= 2; ++frame)
      last = seconds([&] { (void)writer->write(frame, {&pose, 1}); });
    times.writers[k].push_back(last);
  }
}

Times measure(int side, const Options& options) {
  auto simulation =
      Simulation::make(make_scene(side),
                       {.checkpoint_bytes = 0, .threads = options.threads, .profile = true})
          .value();
  const ScratchFolder folder(
      std::filesystem::exists("/dev/shm") ? "/dev/shm" : std::filesystem::temp_directory_path());
  Times times;
  Frame frame = simulation.at(2).value();  // allocates and sets up everything
  SurfacePose pose;
  pose.positions = frame.surfaces()[0].positions();
  const auto begin = std::chrono::steady_clock::now();
  for (int number = 3;; ++number) {
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
    if (number >= 8 && spent.count() > options.seconds) return times;
    const Profile before = simulation.profile();
    frame = simulation.at(number, std::move(frame)).value();
    const double showing =
        seconds([&] { pose.positions = frame.surfaces()[0].positions(std::move(pose.positions)); });
    const Profile after = simulation.profile();
    const auto took = [&](Stage stage) { return after[stage] - before[stage]; };
    times.solve.push_back(took(Stage::SetUp) + took(Stage::Solve));
    times.select.push_back(took(Stage::Sampling) + took(Stage::Selection));
    times.load.push_back(took(Stage::Load));
    times.in.push_back(took(Stage::StateIn));
    times.out.push_back(took(Stage::StateOut));
    times.output.push_back(took(Stage::Output) + showing);
    times.triad.push_back(triad(side));
    if (number % 4 == 3) time_writers(folder, simulation, pose, times);
  }
}

void print_frames(const Options& options) {
  fmt::print("{} in ms; in brackets triads\n", options.is_least ? "least times" : "medians");
  fmt::print("{:>5} {:>7} {:>15} {:>7} {:>7} {:>7} {:>7} {:>7} {:>15}", "side", "triad", "solve",
             "select", "load", "in", "out", "output", "rest");
  for (const std::string& ending : endings) fmt::print(" {:>7}", "." + ending);
  fmt::print(" {:>8} {:>8} {:>6}\n", "frame", "frames/s", "holds");
  for (const int side : options.sides) {
    const Times times = measure(side, options);
    const double one = typical(times.triad, options.is_least);
    double rest = 0;
    for (const auto* part : {&times.select, &times.load, &times.in, &times.out, &times.output})
      rest += typical(*part, options.is_least);
    const auto with_triads = [&](const std::vector<double>& of) {
      return fmt::format("{:.3f} ({:.1f})", typical(of, options.is_least) * 1e3,
                         typical(of, options.is_least) / one);
    };
    const auto plain = [&](const std::vector<double>& of) {
      return fmt::format("{:.3f}", typical(of, options.is_least) * 1e3);
    };
    fmt::print("{:>5} {:>7} {:>15} {:>7} {:>7} {:>7} {:>7} {:>7} {:>15}", side, plain(times.triad),
               with_triads(times.solve), plain(times.select), plain(times.load), plain(times.in),
               plain(times.out), plain(times.output),
               fmt::format("{:.3f} ({:.1f})", rest * 1e3, rest / one));
    double slowest = 0;
    for (const auto& writer : times.writers) {
      slowest = std::max(slowest, typical(writer, options.is_least));
      fmt::print(" {:>7}", plain(writer));
    }
    const double solve = typical(times.solve, options.is_least);
    fmt::print(" {:>8.3f} {:>8.1f} {:>6}\n", (solve + rest) * 1e3, 1 / (solve + rest),
               rest + slowest < solve ? "yes" : "no");
    std::fflush(stdout);
  }
}

// Point forces at random positions of the sheet, each with a radius of a fiftieth of its side.
std::vector<SampledForce> strewn(int count, double extent) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-extent / 2, extent / 2);
  std::vector<SampledForce> forces;
  for (int k = 0; k < count; ++k) {
    const double x = place(random), z = place(random);
    SampledForce& force = forces.emplace_back();
    force.kind = PointForce{{x, 0, z}, {0, 1, 0}};
    force.deformation_radius = extent / 50;
    force.force_radius = extent / 100;
  }
  return forces;
}

Selection look_at_all(const Grid& grid, const Field& nodes, std::span<const SampledForce> forces) {
  Selection selection;
  selection.grid = grid;
  for (const SampledForce& force : forces) {
    ForceSelection selected;
    selected.selector = static_cast<int>(selection.forces.size());
    for (int j = 0; j < grid.rows; ++j) {
      for (int i = 0; i < grid.columns; ++i) {
        const double delta = distance(force.kind, nodes.row(grid.node(i, j)).transpose());
        if (delta < force.deformation_radius) selected.deformation.include(i, j);
        if (delta < force.force_radius) selected.force.include(i, j);
      }
    }
    selection.forces.push_back(selected);
  }
  return recombined(std::move(selection), Combine::Box);
}

void print_selection(const Options& options) {
  constexpr int side = 1001;
  const Mesh mesh = make_mesh({.columns = side, .rows = side, .width = 20, .depth = 20});
  const GridMapping mapping = find_grid(mesh).value();
  const Transform transform;
  fmt::print("\nselection on {} x {} vertices, ms\n{:>7} {:>10} {:>12}\n", side, side, "forces",
             "select", "every one");
  for (const int count : {1, 10, 200}) {
    const std::vector<SampledForce> forces = strewn(count, 20);
    NodeTiles tiles;
    Selection selection;
    std::vector<double> quick, slow;
    for (int round = 0; round < 5; ++round) {
      quick.push_back(seconds([&] {
        tiles.update(mapping.grid, {mapping.rest, transform});
        selection = reselected(std::move(selection), tiles, forces, Combine::Box);
      }));
      if (round > 0 && count > 10) continue;
      Selection all;
      slow.push_back(seconds([&] { all = look_at_all(mapping.grid, mapping.rest, forces); }));
      if (all != selection) fmt::print("DIFFERS\n");
    }
    fmt::print("{:>7} {:>10.3f} {:>12.2f}\n", count, typical(quick, options.is_least) * 1e3,
               typical(slow, options.is_least) * 1e3);
  }
}

// What forces along normals take on a million vertices, and what following takes.
void print_normals_and_follow(const Options& options) {
  constexpr int side = 1001;
  const Mesh mesh = make_mesh({.columns = side, .rows = side, .width = 20, .depth = 20});
  const GridMapping mapping = find_grid(mesh).value();
  const NodeFaces faces =
      node_faces(mesh, mapping.vertex_nodes, static_cast<int>(mapping.rest.rows())).value();
  const Transform transform;
  const PlacedNodes nodes(mapping.rest, transform, nullptr, &faces);
  SampledForce uniform, pressure;
  uniform.kind = UniformForce{};
  pressure.kind = PressureForce{};
  uniform.force_radius = pressure.force_radius = 100;
  const auto loads_of = [&](const SampledForce& force) {
    std::vector<double> times;
    for (int round = 0; round < 9; ++round) {
      times.push_back(seconds([&] {
        Batch sums;
        for (int node = 0; node < side * side; node += batch_size) {
          sums.count = std::min(batch_size, side * side - node);
          nodes.add_loads(node, sums.count, force, 0, sums);
        }
      }));
    }
    return typical(times, options.is_least) * 1e3;
  };
  const double plain = loads_of(uniform), along = loads_of(pressure);
  fmt::print(
      "\nload of one force on {} x {} vertices, ms\nuniform {:.2f}, pressure {:.2f}, "
      "normals {:.2f}\n",
      side, side, plain, along, along - plain);
  // A force that follows by a transform, sampled again and again.
  Scene scene = make_scene(51);
  const auto sampled = [&] {
    const Carriers carriers(scene);
    const auto faults = std::make_shared<ForceFaults>();
    constexpr int count = 100'000;
    std::vector<double> times;
    for (int round = 0; round < 9; ++round) {
      times.push_back(seconds([&] {
        for (int frame = 0; frame < count; ++frame)
          (void)sample_force(scene, scene.forces[0], scene.surfaces[0], frame, faults, carriers);
      }));
    }
    return typical(times, options.is_least) / count * 1e6;
  };
  const double standing = sampled();
  scene.forces[0].follow = "sheet";
  const double following = sampled();
  fmt::print("a force at a frame, us: {:.3f}, one that follows {:.3f}\n", standing, following);
}

}  // namespace

int main(int count, char* arguments[]) {
  Options options;
  if (!read_options(count, arguments,
                    {{"--sides", &options.sides},
                     {"--seconds", &options.seconds},
                     {"--threads", &options.threads},
                     {"--least", &options.is_least}},
                    "frames [--sides 51,101,...] [--seconds S] [--threads N] [--least]"))
    return 2;
  print_frames(options);
  print_selection(options);
  print_normals_and_follow(options);
  return 0;
}
