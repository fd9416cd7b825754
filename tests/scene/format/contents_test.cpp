#include "pliant/scene/format/contents.hpp"

#include <map>
#include <set>
#include <string>
#include <vector>

#include <tinyxml2.h>

#include "pliant/scene/elements/read_elements.hpp"
#include "pliant/scene/elements/write_contents.hpp"
#include "pliant/scene/format/format.hpp"
#include "pliant/scene/format/resolve.hpp"
#include "pliant/scene/text/markup.hpp"
#include "pliant/scene/text/tree.hpp"
#include "support/catch.hpp"
#include "support/harbour.hpp"

namespace pliant::testing {
namespace {

struct ReadHarbour {
  Harbour harbour;
  std::vector<std::string> problems;
  std::map<std::string, int> lines;
};

ReadHarbour read_harbour(const std::string& text) {
  ReadHarbour result;
  const auto sources = std::make_shared<SourceMap>("h.xml", SourceText::of(text));
  xml::SceneFile file{.folder = {},
                      .root = {},
                      .texts = {},
                      .sources = sources,
                      .findings = xml::Findings(sources)};
  const auto markup = xml::scan_markup(file.findings);
  REQUIRE(markup);
  const xml::Tree tree(text, *markup);
  xml::Contents contents = xml::contents_of(result.harbour);
  xml::read_contents(tree.root(), contents, "", file);
  for (const Error& error : file.findings.problems()) result.problems.push_back(error.message);
  for (const auto& [part, place] : file.parts) result.lines[part] = sources->place_of(place).line;
  return result;
}

const std::string harbour_text =
    "<harbour>\n"
    "  <boat name=\"a\">\n"
    "    <rig masts=\"2\">\n"
    "      <animate attribute=\"tension\">\n"
    "        <key frame=\"1\" value=\"1\"/>\n"
    "        <key frame=\"5\" value=\"3\"/>\n"
    "      </animate>\n"
    "      <sail side=\"starboard\" area=\"4\"/>\n"
    "      <sail side=\"port\"/>\n"
    "    </rig>\n"
    "  </boat>\n"
    "  <boat name=\"b\"/>\n"
    "</harbour>";

TEST_CASE("a described element is read, and written as it was", "[scene][contents]") {
  ReadHarbour read = read_harbour(harbour_text);
  CHECK(read.problems.empty());
  REQUIRE(read.harbour.boats.size() == 2);
  const Rig& rig = read.harbour.boats[0].rig;
  CHECK(rig.masts == 2);
  CHECK(rig.tension.at(3)[0] == 2);
  REQUIRE(rig.sails.size() == 2);
  CHECK(rig.sails[0].side == Side::Starboard);
  CHECK(rig.sails[0].area == 4);
  CHECK(read.lines.at("a") == 2);
  CHECK(read.lines.at("a.masts") == 3);
  CHECK(read.lines.at("a.tension") == 4);
  CHECK(read.lines.at("a.sail.port") == 9);
  Harbour standard;
  const auto formats = formats_of(xml::contents_of(standard));
  CHECK(xml::text_of(xml::write_contents(xml::contents_of(read.harbour), formats).element) ==
        harbour_text);
}

TEST_CASE("what is wrong with a described element is told", "[scene][contents]") {
  const auto boat = [](const std::string& rig) {
    return read_harbour("<harbour><boat name=\"a\">" + rig + "</boat></harbour>").problems;
  };
  const std::vector<std::pair<std::string, std::string>> all = {
      {"<rig masts=\"8\"/>", "<rig> masts=\"8\": must be at most 7"},
      {"<rig mast=\"8\"/>", "<rig> has no attribute \"mast\"; did you mean \"masts\"?"},
      {"<rig/><rig/>", "<boat> \"a\" has a second <rig>; the first is at line 1"},
      {"<rgi/>", "<boat> has no element \"rgi\"; did you mean \"rig\"? allowed: rig, animate"},
      {"<rig><sail/></rig>", "<sail> needs the attribute \"side\""},
      {"<rig><sail side=\"port\"/><sail side=\"port\"/></rig>",
       "<rig> has a second <sail> of port; the first is at line 1"},
      {"<rig tension=\"1\"/><animate attribute=\"tension\"><key frame=\"1\" "
       "value=\"0\"/></animate>",
       "<animate> attribute=\"tension\": is already given (line 1); remove one of them"},
  };
  for (const auto& [rig, problem] : all) {
    const std::vector<std::string> problems = boat(rig);
    CAPTURE(rig, problems);
    REQUIRE(problems.size() == 1);
    CHECK(problems[0].find(problem) != std::string::npos);
  }
}

TEST_CASE("a described element is part of the format and its schema", "[scene][contents]") {
  Harbour harbour;
  const auto formats = formats_of(xml::contents_of(harbour));
  const ElementFormat* const rig = find_format(formats, "rig");
  REQUIRE(rig);
  CHECK(rig->meaning == "What carries the sails.");
  CHECK(rig->parents == std::vector<std::string_view>{"boat"});
  CHECK(rig->attributes[0].is_keyable);
  CHECK(rig->children[0].names == std::vector<std::string_view>{"sail"});
  const ElementFormat* const animate = find_format(formats, "animate");
  REQUIRE(animate);
  CHECK(animate->parents == std::vector<std::string_view>{"boat", "rig"});
  CHECK_FALSE(find_format(formats, "include"));

  const std::string schema = schema_of(formats);
  tinyxml2::XMLDocument document;
  REQUIRE(document.Parse(schema.c_str()) == tinyxml2::XML_SUCCESS);
  std::set<std::string> types;
  for (auto* one = document.RootElement()->FirstChildElement("xs:complexType"); one;
       one = one->NextSiblingElement("xs:complexType"))
    types.insert(one->Attribute("name"));
  for (const char* type : {"harbour", "boat", "rig", "sail", "animate.boat", "animate.rig"}) {
    CAPTURE(type);
    CHECK(types.contains(type));
  }
  for (const char* word : {"starboard", "What the wind fills.", "tension"})
    CHECK_THAT(schema, contains_text(word));
}

TEST_CASE("paths lead into described elements", "[scene][contents]") {
  Harbour harbour;
  const auto formats = formats_of(xml::contents_of(harbour));
  const xml::PathScope scope{
      .names = [] { return std::vector<std::string_view>{"a"}; },
      .elements =
          [&](const std::string& name) {
            std::vector<const ElementFormat*> found;
            if (name == "a") found = {find_format(formats, "boat"), find_format(formats, "rig")};
            return found;
          }};
  const auto tension = xml::resolve(scope, "a.tension");
  REQUIRE(tension);
  CHECK(tension->element == "rig");
  CHECK(tension->format->is_keyable);
  CHECK(xml::resolve(scope, "a.tensoin").error().message ==
        R"("a" has no attribute "tensoin"; did you mean "tension"? allowed: name, tension, masts)");
  CHECK_THAT(xml::resolve(scope, "b.masts").error().message,
             contains_text("nothing is named \"b\"; allowed: a"));
}

TEST_CASE("the channels of a described element are found", "[scene][contents]") {
  Boat boat;
  std::vector<std::string> channels;
  for_each_channel(boat, [&](const std::string& name, const Attribute&, const auto&) {
    channels.push_back(name);
  });
  CHECK(channels == std::vector<std::string>{"tension"});
}

}  // namespace
}  // namespace pliant::testing
