#include "pliant/scene/scene.hpp"

#include <memory>
#include <string>
#include <vector>

#include "pliant/scene/text/source_map.hpp"
#include "support/catch.hpp"

namespace pliant {
namespace {

TEST_CASE("the place of a channel is its own, else its element's, else unknown", "[scene]") {
  SceneOrigin origin;
  origin.sources = std::make_shared<SourceMap>(
      "a.xml", std::make_shared<SourceText>("\n\n\n<sheet>\n\n\ndensity"));
  origin.parts = {{"", {0, {0, 1}}},
                  {".fps", {0, {0, 1}}},
                  {"sheet", {0, {4, 9}}},
                  {"sheet.density", {0, {13, 20}}}};
  CHECK(origin.place_of("sheet").line == 4);
  CHECK(origin.place_of("sheet", "density").line == 7);
  CHECK(origin.place_of("sheet", "damping").line == 4);
  CHECK(origin.place_of("poke", "magnitude").line == 0);
  CHECK(origin.place_of("", "fps").line == 1);
  CHECK(SceneOrigin{}.place_of("sheet", "density").line == 0);
  const auto range_of_last = [&](const std::vector<std::string>& of) {
    return origin.last_of("sheet", of).range;
  };
  CHECK(range_of_last({"density", "damping"}) == TextRange{13, 20});
  CHECK(range_of_last({"damping", "density"}) == TextRange{13, 20});
  CHECK(range_of_last({"damping"}) == TextRange{4, 9});
}

TEST_CASE("scenes are compared by all their values, wherever they come from", "[scene]") {
  const auto make = [] {
    Scene scene;
    scene.end = 9;
    Surface sheet{.name = "sheet"};
    sheet.cache.samples = ShapeSamples({Field::Ones(9, 3), Field::Zero(9, 3)});
    sheet.maps.push_back({.channel = MapChannel::Damping, .values = std::vector<double>(9, 0.5)});
    Mesh mesh = make_mesh(GridSheet{.columns = 4, .rows = 3});
    NurbsNet net{.u = {.count = 3, .degree = 2}, .v = {.count = 3, .degree = 2}};
    net.points = Field::Ones(9, 3);
    scene.surfaces = {sheet, {.name = "mesh", .shape = mesh}, {.name = "net", .shape = net}};
    Force poke, custom;
    poke.name = "poke";
    custom.name = "own";
    custom.kind = CustomForce{.key = "a"};
    scene.forces = {poke, custom};
    scene.groups = {{.name = "hand"}};
    return scene;
  };
  const Scene scene = make();
  CHECK(scene == make());
  const std::vector<void (*)(Scene&)> changes = {
      [](Scene& s) { s.fps = 25; },
      [](Scene& s) { s.seed = 1; },
      [](Scene& s) { s.surfaces.pop_back(); },
      [](Scene& s) { std::swap(s.surfaces[0], s.surfaces[1]); },
      [](Scene& s) { s.surfaces[0].enabled = false; },
      [](Scene& s) { s.surfaces[0].shape = GridSheet{.columns = 4}; },
      [](Scene& s) { s.surfaces[0].reading.weld = 0; },
      [](Scene& s) { s.surfaces[0].subdivision = Subdivision{}; },
      [](Scene& s) { s.surfaces[0].cache.path = "a.npy"; },
      [](Scene& s) { s.surfaces[0].cache.samples = {}; },
      [](Scene& s) { s.surfaces[0].cache.samples = ShapeSamples({Field::Ones(9, 3)}); },
      [](Scene& s) {
        s.surfaces[0].cache.samples = ShapeSamples({Field::Ones(9, 3), Field::Ones(9, 3)});
      },
      [](Scene& s) {
        s.surfaces[0].cache.samples = ShapeSamples({Field::Ones(9, 3), Field::Zero(8, 3)});
      },
      [](Scene& s) { s.surfaces[0].maps[0].values[4] = 0.25; },
      [](Scene& s) {
        s.surfaces[0].solver.edges = Edges{};
        s.surfaces[0].solver.preroll = 1;
      },
      [](Scene& s) {
        s.surfaces[0].tangents.su0 = Channel<3>(Value<3>{0, 0, 0});
      },
      [](Scene& s) { std::get<Mesh>(s.surfaces[1].shape).positions(2, 1) += 1e-300; },
      [](Scene& s) { std::get<Mesh>(s.surfaces[1].shape).positions.conservativeResize(11, 3); },
      [](Scene& s) { std::get<Mesh>(s.surfaces[1].shape).object = "other"; },
      [](Scene& s) { std::get<NurbsNet>(s.surfaces[2].shape).points(8, 2) = 2; },
      [](Scene& s) { std::get<NurbsNet>(s.surfaces[2].shape).weights = {2}; },
      [](Scene& s) { s.forces[0].targets = {"sheet"}; },
      [](Scene& s) { s.forces[0].kind = RadialChannels{}; },
      [](Scene& s) { s.forces[1].kind = CustomForce{.key = "b"}; },
      [](Scene& s) { s.forces[1].kind = CustomForce{}; },
      [](Scene& s) {
        s.groups[0].center = Value<3>{0, 0, 1};
      }};
  for (std::size_t k = 0; k < changes.size(); ++k) {
    CAPTURE(k);
    Scene other = make();
    changes[k](other);
    CHECK_FALSE(scene == other);
    CHECK_FALSE(other == scene);
  }
  Scene elsewhere = make();
  elsewhere.origin.file = "a.xml";
  elsewhere.notes.push_back({{.line = 3}, "a note", "a.xml"});
  CHECK(scene == elsewhere);
}

}  // namespace
}  // namespace pliant
