#include "pliant/simulation/animation_bake.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/npy.hpp"
#include "support/scenes.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

namespace {

// Two sheets, one of them moved, of which the first is poked.
Scene moved_pair() {
  Scene s = scene({sheet("a"), sheet("b", 7)}, {poke("f", {0, 0, 0})}, 6);
  s.forces[0].targets = {"a"};
  s.surfaces[0].transform.translate = Value<3>{0, 2, 0};
  s.surfaces[1].transform.translate = Value<3>{30, 0, 0};
  return s;
}

void write_all(AnimationBake& bake, Simulation& simulation, FrameSpan frames) {
  REQUIRE(bake.begin());
  for (int frame = frames.first; frame <= frames.last; ++frame)
    REQUIRE(bake.write(simulation.at(frame).value()));
}

bool is_empty(const ScratchFolder& folder) {
  return std::filesystem::directory_iterator(folder.path()) ==
         std::filesystem::directory_iterator();
}

}  // namespace

TEST_CASE("a bake writes the positions of its frames and counts them", "[simulation][bake]") {
  const ScratchFolder folder;
  auto simulation = Simulation::make(moved_pair()).value();
  const bool is_world = GENERATE(true, false);
  const AnimationOptions options{.file = folder.file("out.npy").string(),
                                 .frames = {2, 5},
                                 .surfaces = {0},
                                 .is_world = is_world};
  auto bake = AnimationBake::make(simulation, options).value();
  CHECK(is_empty(folder));  // it has only planned
  CHECK(bake.surfaces() == std::vector<std::size_t>{0});
  CHECK(bake.vertex_count() == 13 * 13);
  CHECK(bake.plan().first_frame == 2);
  CHECK(bake.plan().last_frame == 5);
  CHECK(bake.plan().is_placed == !is_world);
  REQUIRE(bake.check_inputs());
  write_all(bake, simulation, options.frames);
  CHECK(bake.frame_count() == 4);
  CHECK_FALSE(std::filesystem::exists(options.file));  // it has no name yet
  REQUIRE(bake.finish());

  std::vector<double> numbers;
  double peak = 0;
  for (int number = 2; number <= 5; ++number) {
    const Frame frame = simulation.at(number).value();
    const SurfaceFrame& surface = frame.surfaces()[0];
    const Field positions = is_world ? surface.positions() : surface.object_positions();
    for (Eigen::Index row = 0; row < positions.rows(); ++row)
      for (Eigen::Index axis = 0; axis < 3; ++axis) numbers.push_back(positions(row, axis));
    peak = std::max(peak, surface.told_displacement());
  }
  CHECK(NpyFile::read(options.file).numbers == numbers);
  CHECK(bake.peak_displacement() == peak);
  CHECK(peak > 0.01);
}

TEST_CASE("a bake has all surfaces unless some are chosen", "[simulation][bake]") {
  const ScratchFolder folder;
  auto simulation = Simulation::make(moved_pair()).value();
  const AnimationOptions options{.file = folder.file("out.obj").string(), .frames = {1, 3}};
  auto bake = AnimationBake::make(simulation, options).value();
  CHECK(bake.surfaces() == std::vector<std::size_t>{0, 1});
  CHECK(bake.vertex_count() == 13 * 13 + 7 * 7);
  REQUIRE(bake.plan().surfaces.size() == 2);
  CHECK(bake.plan().surfaces[1].name == "b");
  CHECK(bake.plan().surfaces[1].rest == simulation.at(1).value().surfaces()[1].positions());
  write_all(bake, simulation, options.frames);
  REQUIRE(bake.finish());
  CHECK(bake.file_counts().written == static_cast<int>(files_of(bake.plan()).size()));
  for (const std::string& file : files_of(bake.plan())) CHECK(std::filesystem::exists(file));
}

TEST_CASE("a bake of one file that is not finished leaves nothing", "[simulation][bake]") {
  const ScratchFolder folder;
  auto simulation = Simulation::make(moved_pair()).value();
  {
    auto bake = AnimationBake::make(
                    simulation,
                    {.file = folder.file("out.npy").string(), .frames = {1, 4}, .surfaces = {0}})
                    .value();
    write_all(bake, simulation, {1, 3});
  }
  CHECK(is_empty(folder));
}

TEST_CASE("a bake does not overwrite what its scene reads", "[simulation][bake]") {
  const ScratchFolder folder;
  Scene s = moved_pair();
  const auto mesh = folder.write("head.obj", "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3 4\n");
  s.surfaces[1].shape = MeshFile{.path = mesh.string()};
  s.surfaces[1].reading.uv = UvReading::Surface;
  auto simulation = Simulation::make(s).value();
  const auto bake_to = [&](const std::string& name) {
    return AnimationBake::make(
               simulation, {.file = folder.file(name).string(), .frames = {1, 2}, .surfaces = {1}})
        .value()
        .check_inputs();
  };
  CHECK(bake_to("other.pc2"));
  const auto refused = bake_to("head.pc2");  // which also writes head.obj
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::InvalidInput);
  CHECK_THAT(refused.error().message, Contains("head.obj"));
}

TEST_CASE("a plan of a bake can be stopped", "[simulation][bake]") {
  auto simulation = Simulation::make(moved_pair()).value();
  const auto made = AnimationBake::make(
      simulation, {.file = "out.npy", .frames = {1, 2}, .should_stop = [] { return true; }});
  REQUIRE_FALSE(made);
  CHECK(made.error().code == ErrorCode::Interrupted);
}
