#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pliant/core/shelf.hpp"
#include "pliant/scene/changes/change.hpp"
#include "pliant/simulation/simulation.hpp"
#include "pliant/states/state_store.hpp"
#include "support/catch.hpp"
#include "support/everything.hpp"
#include "support/sanitized.hpp"
#include "support/scenes.hpp"
#include "support/scratch_folder.hpp"

// A shelf that simulations of edited scenes share changes no bit and no error.

using namespace pliant;
using namespace pliant::testing;

namespace {

/// What a simulation of the scene says: its errors, or the hashes of some frames.
std::vector<std::string> told(const Scene& scene, const SimulationOptions& options = {}) {
  auto simulation = Simulation::make(scene, options);
  if (!simulation) return to_lines(simulation.error());
  std::vector<std::string> told;
  for (const int frame : {scene.start, (scene.start + scene.end) / 2, scene.end}) {
    const auto shown = simulation->at(frame);
    if (!shown) return to_lines(shown.error());
    for (const SurfaceFrame& surface : shown->surfaces()) {
      const Hash hash = hash_of(surface.positions());
      told.push_back(fmt::format("{} {} {} {}", frame, surface.name(), hash.high, hash.low));
    }
  }
  return told;
}

void change(Scene& scene, const std::string& typed) {
  CAPTURE(typed);
  REQUIRE(make_changes(scene, std::vector{parse_change(typed).value()}));
}

}  // namespace

TEST_CASE("each channel of a scene can be edited with a shelf and a store", "[simulation][shelf]") {
  Shelf shelf(std::size_t{1} << 30);
  MemoryStateStore store(std::size_t{1} << 30);
  const SimulationOptions shared{.store = &store, .shelf = &shelf};
  const Scene first = of_everything();
  Scene scene = first;
  CHECK(told(scene, shared) == told(scene));
  for (const NamedChannel& named : channels_of(first)) {
    CAPTURE(named.path);
    if (is_sanitized && named.path.size() % 4 != 0) continue;
    std::vector<std::string> value;
    for (const double number : other_value(named, 3)) value.push_back(fmt::format("{}", number));
    if (std::holds_alternative<const Switch*>(named.channel))
      value = {value.front() == "1" ? "true" : "false"};
    change(scene, fmt::format("{}={}", named.path, fmt::join(value, " ")));
    CHECK(told(scene, shared) == told(scene));
  }
}

TEST_CASE("an edit that breaks a rule is refused as without a shelf, and can be taken back",
          "[simulation][shelf]") {
  Shelf shelf(std::size_t{1} << 30);
  const SimulationOptions shared{.shelf = &shelf};
  Scene sound = of_everything();
  // Positive up to the last frame, and then no more.
  sound.surfaces[0].material.density = curve({{-2, 1}, {9, 0.5}, {12, -1}});
  sound.forces[0].deformation_radius = curve({{-4, -1}, {-2, 1}, {9, 2}});
  REQUIRE(told(sound, shared) == told(sound));
  // Each of them is about several channels, or about what other elements say.
  const std::vector<std::vector<std::string>> edits = {
      {"sheet.c=-1"},
      {"sheet.c=-1", "sheet.b=0.2"},
      {"scene.end=12"},
      {"scene.start=-4"},
      {"sheet.preroll=2"},
      {"scene.fps=0.0001"},
      {"sheet.dt=1e-5", "scene.fps=0.1"},
      {"other.su0=1"},
      {"sheet.reference=none", "sheet.goal=1"},
      {"sheet.density=0", "sheet.damping=0", "sheet.region=all", "sheet.edges=free"},
      {"block.round=0.3"},
      {"bar.scale=1 2 1"},
      {"wind.magnitude=1e400"},
      {"pair.deformationRadius=-1", "slide.progress=2"}};
  int refused = 0;
  for (const auto& edit : edits) {
    CAPTURE(edit);
    Scene edited = sound;
    for (const std::string& typed : edit)
      (void)make_changes(edited, std::vector{parse_change(typed).value()});
    const auto expected = told(edited);
    refused += Simulation::make(edited) ? 0 : 1;
    CHECK(told(edited, shared) == expected);
    CHECK(told(edited, shared) == expected);
    CHECK(told(sound, shared) == told(sound));
  }
  CHECK(refused > 7);
}

TEST_CASE("an edit of a force makes no shape anew", "[simulation][shelf]") {
  Shelf shelf(std::size_t{1} << 30);
  const SimulationOptions shared{.shelf = &shelf};
  Surface surface = sheet("sheet");
  surface.shape = make_mesh(std::get<GridSheet>(surface.shape));
  if (GENERATE(false, true)) surface.reading.uv = UvReading::Surface;
  Scene s = scene({surface}, {poke("poke", {0, 0, 0}), poke("other", {3, 0, 0})}, 4);
  REQUIRE(told(s, shared) == told(s));
  const std::size_t before = shelf.kept();
  std::get<PointChannels>(s.forces[0].kind).center = Value<3>{1, 0, 0};
  REQUIRE(Simulation::make(s, shared));
  CHECK(shelf.kept() == before + 1);  // that the force is sound
  REQUIRE(Simulation::make(s, shared));
  CHECK(shelf.kept() == before + 1);
  // A mesh in memory is another one if a number of it differs.
  std::get<Mesh>(s.surfaces[0].shape).positions(60, 1) += 0.5;
  CHECK(told(s, shared) == told(s));
}

TEST_CASE("a driven surface is bound anew only if one of the two is another",
          "[simulation][shelf]") {
  Shelf shelf(std::size_t{1} << 30);
  const SimulationOptions shared{.shelf = &shelf};
  Surface driver = sheet("driver"), skin = sheet("skin", 20);
  skin.driven_by = "driver";
  skin.shape = make_mesh(std::get<GridSheet>(skin.shape));
  skin.transform.scale = Value<3>{0.6, 1, 0.6};
  const int kind = GENERATE(0, 1, 2);
  if (kind == 1) driver.shape = make_mesh(std::get<GridSheet>(driver.shape));
  if (kind == 2) driver.reading.uv = UvReading::Surface;
  Scene s = scene({driver, skin}, {poke("poke", {0, 0, 0})}, 4);
  REQUIRE(told(s, shared) == told(s));
  std::size_t before = shelf.kept();
  s.forces[0].magnitude = 4000;
  REQUIRE(Simulation::make(s, shared));
  CHECK(shelf.kept() == before + 1);  // that the force is sound
  const std::vector<std::function<void()>> edits = {
      [&] {
        s.surfaces[1].transform.translate = Value<3>{1, 0.5, 0};
      },
      [&] {
        s.surfaces[0].transform.rotate = vector_curve({{1, {0, 9, 0}}, {4, {0, 20, 0}}});
      },
      [&] { std::get<Mesh>(s.surfaces[1].shape).positions(7, 1) += 0.25; },
      [&] {
        auto* const mesh = std::get_if<Mesh>(&s.surfaces[0].shape);
        if (mesh)
          mesh->positions(30, 1) += 0.25;
        else
          std::get<GridSheet>(s.surfaces[0].shape).width = 11;
      }};
  for (const auto& edit : edits) {
    edit();
    const std::vector<std::string> expected = told(s);
    before = shelf.kept();
    CHECK(told(s, shared) == expected);
    CHECK(shelf.kept() >= before + 2);  // that the surface is sound or its shape, and the binding
    before = shelf.kept();
    CHECK(told(s, shared) == expected);
    CHECK(shelf.kept() == before);
  }
}

TEST_CASE("a file that changes is read again, whatever the shelf has", "[simulation][shelf]") {
  const ScratchFolder folder;
  Shelf shelf(std::size_t{1} << 30);
  const SimulationOptions shared{.shelf = &shelf};
  const auto write_mesh = [&](double height) {
    std::string text;
    for (int k = 0; k < 25; ++k)
      text += fmt::format("v {} {} {}\nvt {} {}\n", k % 5, k == 12 ? height : 0, k / 5, k % 5 / 4.0,
                          k / 5 / 4.0);
    for (int j = 0; j < 4; ++j) {
      for (int i = 0; i < 4; ++i) {
        const int first = 5 * j + i + 1;
        text += fmt::format("f {0}/{0} {1}/{1} {2}/{2} {3}/{3}\n", first, first + 1, first + 6,
                            first + 5);
      }
    }
    folder.write("mesh.obj", text);
  };
  const auto write_ball = [&](double size) {
    folder.write("ball.obj", fmt::format("v {0} {0} {0}\nv {0} -{0} -{0}\nv -{0} {0} -{0}\n"
                                         "v -{0} -{0} {0}\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n",
                                         size));
  };
  Surface surface = sheet("mesh");
  surface.shape = MeshFile{.path = folder.file("mesh.obj").string()};
  Scene s = scene({surface}, {poke("p", {2, 0, 2})});
  Collider ball{.name = "ball"};
  ball.shape = ClosedMesh{.mesh = {.path = folder.file("ball.obj").string()}};
  ball.transform.translate = Value<3>{2, 0.5, 2};
  s.colliders.push_back(ball);
  std::vector<std::vector<std::string>> seen;
  const auto look = [&] {
    seen.push_back(told(s, shared));
    CHECK(seen.back() == told(s));
  };
  write_mesh(0);
  write_ball(0.3);
  look();
  write_mesh(0.25);
  look();
  write_ball(0.4);
  look();
  std::filesystem::remove(folder.file("mesh.obj"));
  look();
  for (std::size_t k = 1; k < seen.size(); ++k) CHECK(seen[k] != seen[k - 1]);
}
