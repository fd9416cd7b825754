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
      {"scene.fps=0.001"},
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
