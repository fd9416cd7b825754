#include "pliant/scene/write.hpp"

#include <filesystem>
#include <string>
#include <vector>

#include "scene/scene_text.hpp"
#include "support/places.hpp"
#include "support/scene_values.hpp"
#include "support/scenes.hpp"

namespace pliant::testing {
namespace {

Scene check_round_trip(const Scene& scene, const std::string& folder) {
  const Result<std::string> text = to_xml(scene, folder);
  REQUIRE(text);
  CAPTURE(*text);
  const Result<Scene> again = parse_scene(*text, "again.xml", folder);
  if (!again)
    for (const std::string& line : to_lines(again.error())) UNSCOPED_INFO(line);
  REQUIRE(again);
  CHECK(SceneValues(*again).texts() == SceneValues(scene).texts());
  CHECK(to_xml(*again, folder).value() == *text);
  return *again;
}

TEST_CASE("mesh files are named from the folder, wherever that is", "[scene][write]") {
  namespace fs = std::filesystem;
  Scene scene = scene_of(
      "<scene version=\"1\" start=\"1\" end=\"2\"><surface name=\"s\"><mesh "
      "file=\"m.obj\"/></surface></scene>");
  std::get<MeshFile>(scene.surfaces[0].shape).path = "shots/m.obj";
  for (const char* folder : {"shots", "/other", "../out"}) {
    CAPTURE(folder);
    const Scene again = parse_scene(to_xml(scene, folder).value(), "again.xml", folder).value();
    CHECK(fs::weakly_canonical(fs::absolute(std::get<MeshFile>(again.surfaces[0].shape).path)) ==
          fs::weakly_canonical(fs::absolute("shots/m.obj")));
  }
}

TEST_CASE("a written scene is read as it was, to the bit", "[scene][write]") {
  CHECK(check_round_trip(scene_of(rich_scene), "shots") == scene_of(rich_scene));
  for (const char* folder : {"examples", "examples/thesis", "tests/reference/scenes"}) {
    int count = 0;
    for (const auto& entry :
         std::filesystem::directory_iterator(testing::source_folder() / folder)) {
      if (entry.path().extension() != ".xml") continue;
      CAPTURE(entry.path().string());
      const auto scene = load_scene(entry.path().string());
      REQUIRE(scene);
      CHECK(check_round_trip(*scene, entry.path().parent_path().string()) == *scene);
      ++count;
    }
    CHECK(count > 3);
  }
}

TEST_CASE("nets, cages and driven surfaces are written", "[scene][write]") {
  NurbsNet net{.u = {.count = 4, .degree = 2, .knots = {0, 0, 0.1, 0.3, 1, 1, 7}, .samples = 9},
               .v = {.count = 3, .degree = 1, .is_closed = true}};
  net.points = Field::Random(12, 3);
  net.weights = {1, 2, 3, 1e-300, 5, 6, 7, 8, 9, 10, 11, 0.1};
  Surface skin{.name = "skin", .driven_by = "net", .shape = GridSheet{.columns = 3, .rows = 3}};
  skin.material.density = 7;  // does not count, and could not be read
  Surface cage{.name = "cage", .shape = MeshFile{.path = "shots/a.obj"}};
  cage.reading.wrap = Wrap::U;
  cage.subdivision = Subdivision{.levels = 3, .scheme = SubdivisionScheme::Loop};
  Surface mesh{.name = "mesh", .shape = MeshFile{.path = "shots/a.obj"}};
  mesh.reading = {.uv = UvReading::Surface,
                  .unit = {{1, 2}},
                  .axis = {{0, 0, 1}},
                  .border = Border::Free,
                  .weld = 0.1};
  Scene all = scene({{.name = "net", .shape = net}, skin, cage, mesh}, {});
  const std::string text = to_xml(all, "shots").value();
  all.surfaces[1].material = {};
  check_round_trip(all, "shots");
  CHECK(to_xml(all, "shots").value() == text);
}

TEST_CASE("a scene whose loops copy more keys than a file may is not written", "[scene][write]") {
  const auto looped =
      Curve<1>::make({.keys = {{.frame = 1, .value = {0}}, {.frame = 2, .value = {1}}},
                      .loop = Loop<1>{.from = 1, .to = 2, .after = 300'000}})
          .value();
  Scene full = scene({sheet("s")}, {});
  for (const char* const name : {"a", "b", "c", "d"}) {
    CHECK(to_xml(full));
    full.forces.push_back(poke(name, {0, 0, 0}));
    full.forces.back().magnitude = looped;
  }
  CHECK_THAT(to_xml(full).error().message,
             contains_text("1200000 copied keys; a scene file may have 1000000"));
}

TEST_CASE("what a scene file cannot contain is told", "[scene][write]") {
  Scene meshed = scene({sheet("s")}, {});
  meshed.surfaces[0].shape = Mesh{};
  Scene custom = scene({sheet("s")}, {poke("f", {0, 0, 0})});
  custom.forces[0].kind = CustomForce{
      .unit_force = [](const Vector3d&, const ForceTime&) { return Vector3d(0, 1, 0); }};
  Scene apart =
      scene({sheet("s")}, {poke("a", {0, 0, 0}), poke("b", {0, 0, 0}), poke("c", {0, 0, 0})});
  apart.groups.push_back({.name = "g"});
  apart.forces[0].group = apart.forces[2].group = "g";
  Scene steep = scene({sheet("s")}, {poke("f", {0, 0, 0})});
  steep.forces[0].falloff_curve =
      Curve<1>::make({.keys = {{.frame = 0.5, .value = {1}}, {.frame = 1, .value = {0}}},
                      .before = {.kind = Extrapolation<1>::Kind::Linear}})
          .value();
  Scene moved = scene({sheet("s")}, {}), hit = moved;
  moved.surfaces[0].cache.samples = ShapeSamples({Field::Zero(9, 3)});
  hit.colliders = {{.name = "c", .shape = ClosedMesh{.cache = moved.surfaces[0].cache}}};
  Scene solid = hit;
  solid.colliders[0].shape = ClosedMesh{.made = Mesh{}};
  Scene wrong = scene({sheet("s")}, {});
  wrong.fps = -1;
  for (const auto& [bad, part] :
       {std::pair{meshed, "mesh made by a program"}, std::pair{custom, "\"f\" is custom"},
        std::pair{apart, "\"c\" is apart from the other forces"},
        std::pair{moved, "s.cache has samples of a program"},
        std::pair{solid, "collider \"c\" has a mesh made by a program"},
        std::pair{hit, "c.cache has samples of a program"},
        std::pair{steep, "the falloff curve of \"f\" has"}, std::pair{wrong, "fps is -1"}}) {
    const auto text = to_xml(bad);
    REQUIRE_FALSE(text);
    CHECK(text.error().code == ErrorCode::InvalidInput);
    CHECK_THAT(text.error().message, contains_text(part));
  }
}

TEST_CASE("what an interpolation does not read is not written", "[scene][write]") {
  Scene s = scene({sheet("s")}, {poke("f", {0, 0, 0})});
  s.forces[0].magnitude =
      Curve<1>::make(
          {.keys = {{.frame = 1,
                     .value = {0},
                     .next = {.kind = Interpolation::Kind::Linear, .amplitude = 2, .back = 3}},
                    {.frame = 5, .value = {1}}}})
          .value();
  const auto text = to_xml(s);
  REQUIRE(text);
  const auto again = parse_scene(*text, "again.xml", "");
  REQUIRE(again);
  CHECK(again->forces[0].magnitude.at(2) == s.forces[0].magnitude.at(2));
}

TEST_CASE("a new scene in code is written with what differs from the defaults", "[scene][write]") {
  Scene s;
  s.start = 1;
  s.end = 2;
  s.surfaces.push_back({.name = "sheet", .shape = GridSheet{.columns = 3, .rows = 4}});
  Force force;
  force.name = "push";
  force.kind = InertiaChannels{};
  force.magnitude = 1;
  s.forces.push_back(force);
  CHECK(to_xml(s).value() ==
        "<scene version=\"1\" start=\"1\" end=\"2\">\n"
        "  <surface name=\"sheet\">\n"
        "    <grid columns=\"3\" rows=\"4\"/>\n"
        "  </surface>\n"
        "  <inertia name=\"push\"/>\n"
        "</scene>\n");
}

TEST_CASE("a scene whose text could not be read again is not written", "[scene][write]") {
  Scene s = scene({sheet("s")}, {});
  for (const char* path : {"a\x01.obj", "a\xFF.obj"}) {
    s.surfaces[0].shape = MeshFile{.path = path};
    const auto text = to_xml(s);
    REQUIRE_FALSE(text);
    CHECK(text.error().code == ErrorCode::InvalidInput);
  }
}

}  // namespace
}  // namespace pliant::testing
