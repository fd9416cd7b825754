#include "pliant/scene/format/resolve.hpp"

#include <string>
#include <utility>

#include "pliant/scene/channels.hpp"
#include "pliant/scene/read.hpp"
#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::xml;

TEST_CASE("a path has a name, an attribute and at most one part", "[scene][changes]") {
  const auto whole = split_path("sheet.density");
  REQUIRE(whole);
  CHECK(whole->title() == "sheet.density");
  CHECK_FALSE(whole->component());
  CHECK(split_path("poke.center.z")->component() == 2);
  CHECK_FALSE(split_path("poke.center.progress")->component());
  CHECK(split_path("poke.center.closed")->is_of_path());
  CHECK(split_path("a.b.c.d")->part == "c.d");
  for (const auto* const none : {"", ".", "a", "a.", ".a", "a..", "a..b", "a.b."})
    CHECK_FALSE(split_path(none));
}

TEST_CASE("the path of every channel leads to its attribute", "[scene][changes]") {
  Scene scene = parse_scene(R"(<scene version="1" start="1" end="9">
    <surface name="sheet"><grid columns="5" rows="5"/><material yield="3"/>
      <tangents su0="3" sv0="1 2 3"/><solver region="all"/></surface>
    <surface name="other"><grid columns="5" rows="5"/></surface>
    <point name="poke"/><vortex name="wind"/><noise name="gusts"/>
    <radial name="ball"><path attribute="center"><waypoint at="0 0 0"/><waypoint at="4 0 0"/>
      <waypoint at="4 4 0"/></path>
    </radial><group name="hand"><line name="edge"/></group></scene>)",
                            "paths.xml", "")
                    .value();
  std::size_t count = 0;
  for (const NamedChannel& channel : channels_of(scene)) {
    CAPTURE(channel.path);
    const auto at = slot_at(scene, channel.path);
    REQUIRE(at);
    CHECK(channel.path.starts_with(at->path.name + '.' + std::string(at->slot.attribute.name)));
    CHECK(is_channel(at->slot.place));
    ++count;
  }
  CHECK(count > 60);
}

TEST_CASE("a path that leads nowhere is told with the nearest", "[scene][changes]") {
  Scene scene = parse_scene(R"(<scene version="1" start="1" end="2">
    <surface name="sheet"><grid columns="5" rows="5"/></surface></scene>)",
                            "paths.xml", "")
                    .value();
  const std::pair<const char*, const char*> rows[] = {
      {"sheet",
       R"("sheet" is not a path; write NAME.ATTRIBUTE, such as poke.magnitude or scene.fps)"},
      {"shet.density", R"(nothing is named "shet"; did you mean "sheet"? allowed: scene, sheet)"},
      {"sheet.name", "name cannot be changed"},
      {"scene.version", "version cannot be changed"},
      {"sheet.density.w", R"(sheet.density has no part "w"; allowed: x, y, z, progress, closed)"},
      {"sheet.density.x", "sheet.density is a single number, so it has no x, y and z"},
      {"sheet.translate.progress", "sheet.translate is not a position, so it has no progress"},
  };
  for (const auto& [path, complaint] : rows) {
    const auto at = slot_at(scene, path);
    REQUIRE_FALSE(at);
    CHECK(at.error().message == complaint);
  }
}

TEST_CASE("paths lead into forces and meshes of a program", "[scene][changes]") {
  Scene scene = parse_scene(R"(<scene version="1" start="1" end="2">
    <surface name="sheet"><grid columns="5" rows="5"/></surface><point name="poke"/></scene>)",
                            "paths.xml", "")
                    .value();
  scene.surfaces[0].shape = Mesh();
  scene.forces[0].kind = CustomForce();
  for (const NamedChannel& channel : channels_of(scene)) {
    CAPTURE(channel.path);
    CHECK(slot_at(scene, channel.path));
  }
  CHECK(
      slot_at(scene, "poke.magnitud")
          .error()
          .message.starts_with(
              R"("poke" has no attribute "magnitud"; did you mean "magnitude"? allowed: name, enabled)"));
  CHECK(slot_at(scene, "sheet.columns").error().message.starts_with(R"("sheet" has no attribute)"));
  CHECK(no_channel(scene, "poke.center").starts_with(R"("poke" has no attribute "center")"));
}
