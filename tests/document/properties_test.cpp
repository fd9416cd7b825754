// What is told of each attribute is what the scene says, and what an operation may set.

#include "pliant/document/properties.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "pliant/scene/channels.hpp"
#include "pliant/scene/format/resolve.hpp"
#include "pliant/scene/text/text.hpp"
#include "pliant/scene/write.hpp"
#include "support/catch.hpp"
#include "support/everything.hpp"
#include "support/places.hpp"
#include "support/random_scene.hpp"
#include "support/scratch_folder.hpp"

namespace pliant::testing {
namespace {

using Json = nlohmann::json;

SceneDocument read_from(const std::string& text) {
  auto document = SceneDocument::from_text(text, "shot.xml", "");
  if (!document)
    for (const std::string& line : to_lines(document.error())) UNSCOPED_INFO(line);
  REQUIRE(document);
  return *std::move(document);
}

Json told_of(const SceneDocument& document) {
  const auto json = properties_json(document);
  REQUIRE(json);
  return Json::parse(*json);
}

/// What is told of a thing among others.
Json named(const Json& list, const std::string& name, const char* by = "name") {
  for (const Json& one : list)
    if (one[by] == name) return one;
  FAIL("nothing is told of " << name);
  return {};
}

Json attribute(const Json& objects, const std::string& path) {
  return named(named(objects, path.substr(0, path.find('.')))["attributes"], path, "path");
}

/// The formats of an object and of all that it has attributes of.
std::vector<const ElementFormat*> formats_of(const Scene& scene, const std::string& name) {
  return xml::scope_of(scene).elements(name);
}

void check_all_are_told(const SceneDocument& document, const Json& objects) {
  const Scene& scene = document.scene();
  CHECK(objects.size() == 1 + scene.surfaces.size() + scene.forces.size() + scene.groups.size() +
                              scene.colliders.size());
  CHECK(objects.front()["name"] == "scene");
  for (const Json& object : objects) {
    CAPTURE(object["name"]);
    std::vector<std::string> expected, told;
    for (const ElementFormat* const element : formats_of(scene, object["name"]))
      for (const AttributeFormat& row : element->attributes)
        if (row.need != Need::Later && row.name != "name" && row.name != "version")
          expected.push_back(
              fmt::format("{} {}.{}", element->name, object["name"].get<std::string>(), row.name));
    for (const Json& one : object["attributes"])
      if (one["element"] != "path")
        told.push_back(fmt::format("{} {}", one["element"].get<std::string>(),
                                   one["path"].get<std::string>()));
    CHECK(told == expected);
  }
}

/// Each value is what an operation takes, and means what the scene says; what is given is what a
/// reset takes away.
void check_values(const SceneDocument& document, const Json& objects) {
  for (const Json& object : objects) {
    for (const Json& one : object["attributes"]) {
      const std::string path = one["path"], value = one["value"];
      const bool is_given = one["given"];
      CAPTURE(document.file(), path, value);
      if (one["animated"]) CHECK((value.empty() && is_given));
      SceneDocument copy = document;
      if (one.contains("file")) {
        CHECK_FALSE(copy.apply({edit::Set{path, value.empty() ? "1" : value}}));
        continue;
      }
      const auto reset = copy.apply({edit::Reset{path}});
      CHECK((!reset || !reset->edits.empty()) == is_given);
      const AttributeFormat& format = *std::ranges::find(
          find_format(scene_format(), one["element"].get<std::string>())->attributes,
          one["name"].get<std::string>(), &AttributeFormat::name);
      if (!is_given) CHECK(value == format.text);
      if (one["animated"] || one.contains("excluded") || value.empty()) continue;
      copy = document;
      const auto set = copy.apply({edit::Set{path, value}});
      if (set) {
        CHECK(copy.scene() == document.scene());
        continue;
      }
      // It depends on another attribute whether it may be given.
      CHECK_FALSE(is_given);
      CHECK_THAT(set.error().message, contains_text(path));
    }
  }
}

void check_lines(const SceneDocument& document, const Json& objects) {
  std::vector<std::string> lines = {""};
  for (const char c : document.text())
    if (c == '\n')
      lines.emplace_back();
    else
      lines.back() += c;
  int last_first = 0;
  for (const Json& object : objects) {
    if (object.contains("file")) continue;
    CAPTURE(document.file(), object["name"]);
    const int first = object["lines"][0], last = object["lines"][1];
    CHECK(first >= last_first);
    last_first = first;
    REQUIRE(last <= static_cast<int>(lines.size()));
    const std::string kind = object["kind"];
    CHECK_THAT(lines.at(first - 1), contains_text("<" + kind));
    const std::string& closing = lines.at(last - 1);
    CHECK((closing.find("</" + kind + ">") != std::string::npos ||
           closing.find("/>") != std::string::npos));
  }
}

void check_channels(const SceneDocument& document, const Json& objects) {
  for (const NamedChannel& channel : channels_of(document.scene())) {
    CAPTURE(document.file(), channel.path);
    const Json one = attribute(objects, channel.path);
    CHECK(one["components"] == value_at(channel, 1).size());
    CHECK(one["animated"] == channel.is_animated());
    if (channel.is_animated()) continue;
    const std::string value = one["value"];
    std::vector<double> numbers;
    for (const std::string_view word : xml::words_of(value))
      numbers.push_back(word == "true" ? 1 : word == "false" ? 0 : xml::parse_number(word).value());
    CHECK(numbers == value_at(channel, 1));
  }
}

/// All but the values: to set each of a long scene takes long.
Json check_what_is_told(const SceneDocument& document) {
  Json objects = told_of(document);
  check_all_are_told(document, objects);
  check_lines(document, objects);
  check_channels(document, objects);
  return objects;
}

void check(const SceneDocument& document) { check_values(document, check_what_is_told(document)); }

TEST_CASE("every attribute of every kind of thing is told, and may be set to what it is",
          "[document][properties]") {
  const auto text = to_xml(of_everything());
  REQUIRE(text);
  check(read_from(*text));
}

TEST_CASE("all attributes of the examples are told", "[document][properties]") {
  for (const char* const folder : {"examples", "examples/thesis", "examples/sharing"}) {
    for (const auto& entry :
         std::filesystem::directory_iterator(testing::source_folder() / folder)) {
      if (entry.path().extension() != ".xml") continue;
      const auto document = SceneDocument::open(entry.path().string());
      REQUIRE(document);
      check_what_is_told(*document);
    }
  }
}

const std::string told_scene = R"(<scene version="1" start="1" end="9" fps="24000/1001">
  <define name="push" value="4"/>
  <surface name="sheet"><grid columns="5" rows="5"/></surface>
  <group name="pair" deformationRadius="3">
    <point name="poke" magnitude="2 * $push" center=" 1.0  2 3">
      <falloff><key at="0" value="1"/><key at="1" value="0"/></falloff>
    </point>
  </group>
  <radial name="swell">
    <path attribute="center" progress="0.5"><waypoint at="0 0 0"/><waypoint at="1 0 0"/><waypoint
      at="1 0 1"/></path>
    <animate attribute="magnitude"><key frame="1" value="1"/></animate>
  </radial>
  <collider name="ball"><sphere/></collider>
</scene>)";

TEST_CASE("values are told as they are written and as they are meant", "[document][properties]") {
  const SceneDocument document = read_from(told_scene);
  const Json objects = told_of(document);
  check(document);
  // A rate and numbers as they are written.
  CHECK(attribute(objects, "scene.fps")["value"] == "24000/1001");
  CHECK(attribute(objects, "poke.center")["value"] == "1.0 2 3");
  CHECK(attribute(objects, "poke.center")["components"] == 3);
  // Of definitions both.
  CHECK(attribute(objects, "poke.magnitude")["value"] == "8");
  CHECK(attribute(objects, "poke.magnitude")["written"] == "2 * $push");
  CHECK_FALSE(attribute(objects, "poke.center").contains("written"));
  // A group, and what it forbids.
  CHECK(named(objects, "poke")["group"] == "pair");
  CHECK_FALSE(named(objects, "swell").contains("group"));
  CHECK_THAT(attribute(objects, "poke.deformationRadius")["excluded"].get<std::string>(),
             contains_text("a force in a <group> must not have one"));
  CHECK_FALSE(attribute(objects, "pair.deformationRadius").contains("excluded"));
  // Curves and paths.
  const Json falloff = attribute(objects, "poke.falloff");
  CHECK((falloff["animated"] && falloff["value"] == "" && falloff["components"] == 0));
  CHECK(attribute(objects, "swell.magnitude")["animated"] == true);
  CHECK(attribute(objects, "swell.center")["animated"] == true);
  const Json progress = attribute(objects, "swell.center.progress");
  CHECK((progress["name"] == "progress" && progress["element"] == "path"));
  CHECK((progress["value"] == "0.5" && progress["given"] == true && progress["components"] == 1));
  CHECK(attribute(objects, "swell.center.closed")["value"] == "false");
  // Shapes, and parts that are absent.
  CHECK(named(objects, "ball")["shape"] == "sphere");
  CHECK(named(objects, "sheet")["shape"] == "grid");
  CHECK_FALSE(named(objects, "pair").contains("shape"));
  CHECK(attribute(objects, "ball.translate")["element"] == "transform");
  CHECK(attribute(objects, "sheet.density")["given"] == false);
}

TEST_CASE("a dollar that stands for itself is told as one that may be set",
          "[document][properties]") {
  const SceneDocument document =
      read_from(R"(<scene version="1" start="1" end="9"><define name="dir" value="a"/>
  <surface name="sheet"><grid columns="5" rows="5" cache="$dir/b$$c.npy"/></surface></scene>)");
  const Json cache = attribute(told_of(document), "sheet.cache");
  CHECK(cache["value"] == "a/b$$c.npy");
  CHECK(cache["written"] == "$dir/b$$c.npy");
  SceneDocument copy = document;
  REQUIRE(copy.apply({edit::Set{"sheet.cache", cache["value"]}}));
  CHECK(copy.scene() == document.scene());
}

TEST_CASE("what stands in an included file is told with it", "[document][properties]") {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder.file("parts"));
  folder.write("parts/rig.xml", R"(<scene>
  <group name="pair" deformationRadius="2">
    <point name="left" magnitude="2"/>
  </group>
  <surface name="skin"><grid columns="3" rows="3" cache="skin.npy"/></surface>
</scene>)");
  folder.write("parts/soft.xml", "<material density=\"4\"/>");
  folder.write("parts/swing.xml",
               "<animate attribute=\"magnitude\"><key frame=\"1\" value=\"1\"/></animate>");
  const auto file = folder.write("shot.xml", R"(<scene version="1" start="1" end="9">
  <point name="first"/>
  <include file="parts/rig.xml"/>
  <surface name="sheet"><grid columns="5" rows="5"/><include file="parts/soft.xml"/></surface>
  <point name="last"><include file="parts/swing.xml"/></point>
</scene>)");
  const auto document = SceneDocument::open(file.string());
  REQUIRE(document);
  check(*document);
  const Json objects = told_of(*document);
  std::vector<std::string> names;
  for (const Json& object : objects) names.push_back(object["name"]);
  CHECK(names ==
        std::vector<std::string>{"scene", "first", "pair", "left", "skin", "sheet", "last"});
  const Json left = named(objects, "left");
  CHECK((left["file"] == "parts/rig.xml" && left["lines"] == Json{3, 3}));
  CHECK(attribute(objects, "left.magnitude")["file"] == "parts/rig.xml");
  CHECK(attribute(objects, "left.magnitude")["value"] == "2");
  // A file as seen from the document.
  CHECK(attribute(objects, "skin.cache")["value"] == "parts/skin.npy");
  // A part, and a curve, of a thing that stands here.
  CHECK_FALSE(named(objects, "sheet").contains("file"));
  CHECK(attribute(objects, "sheet.density")["file"] == "parts/soft.xml");
  CHECK(attribute(objects, "sheet.density")["value"] == "4");
  CHECK(attribute(objects, "sheet.damping")["file"] == "parts/soft.xml");
  CHECK_FALSE(attribute(objects, "sheet.dt").contains("file"));
  CHECK(attribute(objects, "last.magnitude")["file"] == "parts/swing.xml");
  CHECK_FALSE(attribute(objects, "last.center").contains("file"));
}

TEST_CASE("any scene is told whole", "[document][properties][random]") {
  for (unsigned seed = 0; seed < 40; ++seed) {
    CAPTURE(seed);
    const SceneDocument document = read_from(RandomScene(seed).text());
    const Json objects = told_of(document);
    check_all_are_told(document, objects);
    check_channels(document, objects);
  }
}

TEST_CASE("the telling of properties can be stopped", "[document][properties]") {
  std::string text = "<scene version=\"1\" start=\"1\" end=\"9\">";
  for (int k = 0; k < 100; ++k) text += fmt::format("<point name=\"p{}\"/>", k);
  const SceneDocument document = read_from(text + "</scene>");
  const auto told = properties_json(document, [] { return true; });
  REQUIRE_FALSE(told);
  CHECK(told.error().code == ErrorCode::Interrupted);
}

}  // namespace
}  // namespace pliant::testing
