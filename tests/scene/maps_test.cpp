#include <string>
#include <vector>

#include "pliant/scene/checks/check.hpp"
#include "pliant/scene/inputs.hpp"
#include "pliant/scene/read.hpp"
#include "pliant/scene/write.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

// <map> in scene files, and `Surface::maps` in code.

namespace {

std::string scene_of_maps(const std::string& maps, const std::string& shape = "",
                          const std::string& solver = "") {
  return "<scene version=\"1\" start=\"1\" end=\"2\">\n<surface name=\"s\">\n" +
         (shape.empty() ? std::string(R"(<grid columns="5" rows="5"/>)") : shape) +
         "\n<material b=\"3\">\n" + maps + "\n</material>\n" + solver + "</surface>\n</scene>\n";
}

std::vector<std::string> lines_of(const std::string& text) {
  const auto scene = parse_scene(text, "a.xml", "/folder", "/folder");
  return scene ? std::vector<std::string>() : to_lines(scene.error());
}

std::string first_rule_of(const Surface& surface) {
  const std::vector<Error> errors = check_scene(scene({surface}, {}));
  return errors.empty() ? "none" : errors.front().message;
}

}  // namespace

TEST_CASE("maps are read into their surface, and written again", "[scene][maps]") {
  const std::string text = scene_of_maps(
      R"(<map channel="b" file="soft.png" low="0.2" high="1.5"/>)"
      "\n"
      R"(<animate attribute="c"><key frame="1" value="2"/><key frame="2" value="3"/></animate>)"
      "\n"
      R"(<map channel="damping" attribute="_THICK" high="-2"/>)",
      R"(<mesh file="m.glb"/>)");
  const auto scene = parse_scene(text, "/folder/a.xml", "/folder", "/folder");
  REQUIRE(scene);
  const std::vector<MaterialMap>& maps = scene->surfaces[0].maps;
  REQUIRE(maps.size() == 2);
  CHECK(maps[0].channel == MapChannel::B);
  CHECK(maps[0].file == "/folder/soft.png");
  CHECK(maps[0].attribute.empty());
  CHECK(maps[0].low == 0.2);
  CHECK(maps[0].high == 1.5);
  CHECK(maps[1].channel == MapChannel::Damping);
  CHECK(maps[1].file.empty());
  CHECK(maps[1].attribute == "_THICK");
  CHECK(maps[1].low == 0);
  CHECK(maps[1].high == -2);
  CHECK(scene->origin.place_of("s", "map.b").line == 5);
  CHECK(scene->origin.place_of("s", "map.damping").line == 7);

  const std::string written = to_xml(*scene, "/folder").value();
  CHECK_THAT(written, Contains(R"(<map channel="b" file="soft.png" low="0.2" high="1.5"/>)"));
  CHECK_THAT(written, Contains(R"(<map channel="damping" attribute="_THICK" high="-2"/>)"));
  const auto again = parse_scene(written, "/folder/a.xml", "/folder", "/folder");
  REQUIRE(again);
  CHECK(to_xml(*again, "/folder").value() == written);
  CHECK(again->surfaces[0].maps[0].file == maps[0].file);
}

TEST_CASE("a material with nothing but a map is written", "[scene][maps]") {
  Surface surface = sheet("s");
  surface.material = {};
  surface.maps = {{.channel = MapChannel::Density, .file = "m.png"}};
  const std::string text = to_xml(scene({surface}, {}), "").value();
  CHECK_THAT(text, Contains("<material>"));
  CHECK_THAT(text, Contains(R"(<map channel="density" file="m.png"/>)"));
  surface.maps[0].file.clear();
  surface.maps[0].values.assign(169, 1.0);
  const auto none = to_xml(scene({surface}, {}), "");
  REQUIRE_FALSE(none);
  CHECK_THAT(none.error().message, Contains("s.map.density has values of a program"));
}

TEST_CASE("a map of what does not yield is told", "[scene][maps]") {
  const auto notes = [](const std::string& map) {
    const std::string text =
        "<scene start=\"1\" end=\"2\"><surface name=\"s\"><mesh file=\"a.ply\"/>"
        "\n<material" +
        map + "</material></surface></scene>";
    return parse_scene(text, "a.xml", "").value().notes;
  };
  const std::string map = "<map channel=\"hardening\" attribute=\"soft\"/>";
  CHECK(notes(" yield=\"3\">" + map).empty());
  const auto told = notes(">" + map);
  REQUIRE(told.size() == 1);
  CHECK(told[0].line == 2);
  CHECK_THAT(told[0].message,
             Contains("s.map.hardening: the map has no effect: s.yield is not given"));
}

TEST_CASE("every problem of a map is told with its line", "[scene][maps]") {
  struct Bad {
    std::string map;
    std::string line;
  };
  const std::vector<Bad> all = {
      {R"(<map file="a.png"/>)", "a.xml:5: error: <map> needs the attribute \"channel\""},
      {R"(<map channel="e" file="a.png"/>)", "a.xml:5: error: <map> channel=\"e\": unknown word"},
      {R"(<map channel="b"/>)", "a.xml:5: error: s.map.b: a map needs a file or an attribute"},
      {R"(<map channel="b" file="a.png" attribute="x"/>)",
       "a.xml:5: error: s.map.b: a map has a file or an attribute, but this one has both"},
      {R"(<map channel="b" file="a.jpg"/>)",
       "a.xml:5: error: s.map.b: the file is \"/folder/a.jpg\", but its name must end in .png or"},
      {R"(<map channel="b" file=""/>)", "a.xml:5: error: <map> file=\"\": is empty"},
      {R"(<map channel="b" file="a.png" low="1,5"/>)", "a.xml:5: error: <map> low=\"1,5\""},
      {R"(<map channel="b" file="a.png" high="nan"/>)", "a.xml:5: error: <map> high=\"nan\""},
      {R"(<map channel="b" file="a.png" lo="1"/>)",
       "a.xml:5: error: <map> has no attribute \"lo\"; did you mean \"low\"?"},
      {R"(<map channel="b" file="a.png"><key/></map>)", "a.xml:5: error: <map> has no element"},
      {"<map channel=\"b\" file=\"a.png\"/>\n<map channel=\"b\" file=\"b.png\"/>",
       "a.xml:6: error: <material> has a second <map> of b; the first is at line 5"}};
  for (const auto& [map, line] : all) {
    CAPTURE(map);
    std::string lines;
    for (const std::string& one : lines_of(scene_of_maps(map))) lines += one + '\n';
    CHECK_THAT(lines, Contains(line));
  }
  CHECK_THAT(
      lines_of(scene_of_maps(R"(<map channel="b" attribute="x"/>)")).front(),
      Contains("s.map.b: the attribute \"x\" is one of a mesh's vertices, but the surface is "
               "no <mesh> and no <subdivision>"));
  // A file that is not there is told beside another problem.
  const std::vector<std::string> both =
      lines_of(scene_of_maps("<map channel=\"b\" file=\"none.png\"/>\n<map channel=\"c\"/>"));
  REQUIRE(both.size() == 2);
  CHECK_THAT(both[0], Contains("a.xml:5: error: surface \"s\": /folder/none.png: cannot read"));
  CHECK_THAT(both[1], Contains("a.xml:6: error: s.map.c: a map needs"));
}

TEST_CASE("maps of stiffness are not for unions, those of density are", "[scene][maps]") {
  const std::string solver = "<solver combine=\"union\"/>";
  for (const std::string channel : {"b", "c", "d"}) {
    const auto lines =
        lines_of(scene_of_maps("<map channel=\"" + channel + "\" file=\"a.png\"/>", "", solver));
    REQUIRE(lines.size() == 2);  // and the file is not there
    CHECK_THAT(lines[0] + lines[1], Contains("a.xml:7: error: s.map." + channel +
                                             ": a map of b, c or d needs rectangles, but s.combine "
                                             "is \"union\""));
  }
  for (const std::string channel : {"density", "damping"})
    CHECK(lines_of(scene_of_maps("<map channel=\"" + channel + "\" file=\"a.png\"/>", "", solver))
              .empty());
}

TEST_CASE("a map of damping is not for a damping ratio", "[scene][maps]") {
  const std::string text = scene_of_maps(R"(<map channel="damping" file="a.png"/>)");
  const std::string ratio = R"(<material dampingRatio="0.1">)";
  const auto lines = lines_of(std::string(text).replace(text.find("<material b"), 16, ratio));
  REQUIRE_FALSE(lines.empty());
  CHECK_THAT(lines[0],
             Contains("a.xml:5: error: s.map.damping: s.dampingRatio gives the damping by "
                      "the density of each node; remove one of them"));
}

TEST_CASE("maps in code keep the rules of files", "[scene][maps]") {
  Surface surface = sheet("s");
  surface.maps = {{.channel = MapChannel::B, .values = {1}}};
  CHECK(first_rule_of(surface) == "none");
  surface.maps.push_back({.channel = MapChannel::B, .values = {1}});
  CHECK_THAT(first_rule_of(surface), Contains("s.map.b: the channel has a map already"));
  surface.maps.pop_back();
  surface.maps[0].file = "a.png";
  CHECK_THAT(first_rule_of(surface), Contains("this one has both"));
  surface.maps[0] = {.channel = MapChannel::D};
  CHECK_THAT(first_rule_of(surface), Contains("s.map.d: a map needs a file or an attribute"));
  surface.maps[0] = {
      .channel = MapChannel::D, .high = std::numeric_limits<double>::infinity(), .values = {1}};
  CHECK_THAT(first_rule_of(surface), Contains("s.map.d.high is inf, but must be finite"));
}

TEST_CASE("the files of maps are inputs of the scene", "[scene][maps][inputs]") {
  const auto scene = parse_scene(
      scene_of_maps("<map channel=\"b\" file=\"a.png\"/><map channel=\"c\" file=\"a.png\"/>"
                    "<map channel=\"d\" file=\"n.npy\"/>"),
      "/folder/a.xml", "/folder", "/folder");
  REQUIRE(scene);
  const auto inputs = inputs_of(*scene);
  REQUIRE(inputs.size() == 3);
  CHECK(inputs[1].file == "/folder/a.png");
  CHECK(inputs[1].role == "a map of the scene");
  CHECK(inputs[2].file == "/folder/n.npy");
}
