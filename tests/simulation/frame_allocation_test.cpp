// From the third frame on, playing a scene into files allocates nothing while its regions keep
// their shape. A separate executable, since it counts all allocations of the process.

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "pliant/pliant.hpp"
#include "support/count_allocations.hpp"

namespace {

using namespace pliant;

Force force_at(double x, double z, double radius, std::string name) {
  Force force;
  force.name = std::move(name);
  force.kind = PointChannels{.center = Value<3>{x, 0, z}};
  force.magnitude =
      Curve<1>::make({.keys = {{.frame = 1, .value = {0}}, {.frame = 20, .value = {900}}}}).value();
  force.deformation_radius = radius;
  force.force_radius = 3;
  force.falloff = Falloff::Smooth;
  return force;
}

// Large enough to use threads, and with names too long for the short-string optimisation.
Scene scene_of(int side, Combine combine) {
  Scene scene;
  scene.end = 40;
  Surface sheet;
  sheet.name = "a-sheet-with-a-rather-long-name";
  sheet.shape = GridSheet{.columns = side, .rows = side, .width = 20, .depth = 20};
  sheet.transform.rotate = Value<3>{0, 30, 5};
  sheet.material.density = 40.0;
  sheet.material.damping = 20.0;
  sheet.solver.measure = Measure::Rest;
  sheet.solver.combine = combine;
  scene.surfaces.push_back(std::move(sheet));
  scene.forces.push_back(force_at(-5, 0, 4, "the-first-of-two-forces-that-poke"));
  scene.forces.push_back(force_at(5, 0, 4, "the-second-of-two-forces-that-poke"));
  return scene;
}

// Allocations in frames, after the first ones.
long allocations_of(int side, Combine combine, int threads, const std::string& ending) {
  const auto file = std::filesystem::temp_directory_path() /
                    ("pliant-allocation-" + std::to_string(side) + "." + ending);
  auto simulation = Simulation::make(scene_of(side, combine),
                                     {.checkpoint_bytes = 0, .threads = threads, .profile = true})
                        .value();
  const RestShape& shape = simulation.rest_shapes()[0];
  const auto writer = make_writer({.file = file,
                                   .surfaces = {{shape.name, &shape.mesh, shape.mesh.positions}},
                                   .first_frame = 1,
                                   .last_frame = 12})
                          .value();
  Frame frame;
  std::vector<SurfacePose> poses(1);
  long before = 0;
  for (int number = 1; number <= 12; ++number) {
    if (number == 5) before = testing::allocations;
    auto next = simulation.at(number, std::move(frame));
    if (!next) std::abort();
    frame = *std::move(next);
    poses[0].positions = frame.surfaces()[0].positions(std::move(poses[0].positions));
    if (!writer->write(number, poses)) std::abort();
  }
  const long count = testing::allocations - before;
  if (frame.surfaces()[0].peak_displacement() == 0) std::abort();
  for (int number = 1; number <= 12; ++number) {
    std::error_code ignored;
    char digits[16];
    std::snprintf(digits, sizeof(digits), ".%04d.", number);
    std::filesystem::remove(std::filesystem::path(file).replace_extension(digits + ending),
                            ignored);
  }
  return count;
}

}  // namespace

int main() {
  bool is_right = true;
  for (const Combine combine : {Combine::Box, Combine::Islands}) {
    for (const int threads : {1, 2}) {
      for (const char* ending : {"npy", "pc2", "mdd"}) {
        const long count = allocations_of(161, combine, threads, ending);
        std::printf("%s, %d threads: %ld allocations in 8 frames\n", ending, threads, count);
        is_right = is_right && count == 0;
      }
    }
  }
  // With one file per frame, file names are allocated, independent of the number of vertices.
  const long small = allocations_of(41, Combine::Box, 1, "ply");
  const long large = allocations_of(161, Combine::Box, 1, "ply");
  std::printf("ply: %ld and %ld allocations in 8 frames\n", small, large);
  return is_right && small > 0 && small == large && small < 8 * 40 ? 0 : 1;
}
