#include "pliant/scene/format/schema.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include <tinyxml2.h>

#include "pliant/scene/format/format.hpp"
#include "scene/scene_text.hpp"
#include "support/places.hpp"

namespace pliant::testing {
namespace {

const std::filesystem::path schema_file = testing::source_folder() / "docs/pliant-scene.xsd";

TEST_CASE("the schema of the documents is the one that the format makes", "[scene][schema]") {
  std::ifstream file(schema_file, std::ios::binary);
  REQUIRE(file);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  INFO("pliant_tests '[.schema]' writes it anew");
  CHECK((text == scene_schema()));
}

// Hidden: not a test, but the way to write the file after a change of the format.
TEST_CASE("write the schema of the documents", "[.schema]") {
  std::ofstream file(schema_file, std::ios::binary);
  file << scene_schema();
  CHECK(file.flush());
}

/// Visits an element and all in it.
template <class Visit>
void walk(const tinyxml2::XMLElement& element, const Visit& visit) {
  visit(element);
  for (const auto* child = element.FirstChildElement(); child; child = child->NextSiblingElement())
    walk(*child, visit);
}

std::string attribute_of(const tinyxml2::XMLElement& element, const char* name) {
  const char* const value = element.Attribute(name);
  return value ? value : "";
}

TEST_CASE("the schema documents every element and every attribute", "[scene][schema]") {
  tinyxml2::XMLDocument document;
  REQUIRE(document.Parse(scene_schema().c_str()) == tinyxml2::XML_SUCCESS);
  std::set<std::string> documented, elements, attributes;
  walk(*document.RootElement(), [&](const tinyxml2::XMLElement& element) {
    const std::string kind = element.Name(), name = attribute_of(element, "name");
    if (kind == "xs:element" && !name.empty()) elements.insert(name);
    if (kind == "xs:attribute") attributes.insert(name);
    if (kind != "xs:element" && kind != "xs:attribute") return;
    const auto* annotation = element.FirstChildElement("xs:annotation");
    const auto* text = annotation ? annotation->FirstChildElement("xs:documentation") : nullptr;
    CAPTURE(kind, name);
    if (kind == "xs:attribute") CHECK((text && text->GetText() != std::string("..")));
    if (text) documented.insert(name);
  });
  for (const ElementFormat& format : scene_format()) {
    CAPTURE(format.name);
    CHECK(elements.contains(std::string(format.name)));
    CHECK(documented.contains(std::string(format.name)));
    for (const AttributeFormat& attribute : format.attributes)
      if (attribute.need != Need::Later) CHECK(attributes.contains(std::string(attribute.name)));
  }
  for (const char* name : {"include", "define", "fragment"}) CHECK(documented.contains(name));
}

TEST_CASE("the types of the schema are defined once, and all are used", "[scene][schema]") {
  tinyxml2::XMLDocument document;
  REQUIRE(document.Parse(scene_schema().c_str()) == tinyxml2::XML_SUCCESS);
  std::multiset<std::string> defined;
  std::set<std::string> used;
  walk(*document.RootElement(), [&](const tinyxml2::XMLElement& element) {
    const std::string kind = element.Name();
    if (kind == "xs:simpleType" || kind == "xs:complexType")
      if (const std::string name = attribute_of(element, "name"); !name.empty())
        defined.insert(name);
    for (const char* reference : {"type", "base", "memberTypes"})
      used.insert(attribute_of(element, reference));
  });
  for (const std::string& name : defined) {
    CAPTURE(name);
    CHECK(defined.count(name) == 1);
    CHECK(used.contains(name));
  }
}

TEST_CASE("the root may name its schema for editors", "[scene][schema]") {
  const std::string xsi = "xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\"";
  const std::string location = "xsi:noNamespaceSchemaLocation=\"pliant-scene.xsd\"";
  const auto scene = [](const std::string& attributes, const std::string& of_surface = "") {
    return "<?xml version=\"1.0\"?>\n<?xml-model href=\"pliant-scene.xsd\"?>\n<scene start=\"1\" "
           "end=\"9\" " +
           attributes + "><surface name=\"sheet\" " + of_surface +
           "><grid columns=\"3\" rows=\"3\"/></surface></scene>";
  };
  CHECK(problems_of(scene("")).empty());
  CHECK(problems_of(scene(xsi + ' ' + location)).empty());
  // Nothing else of these names, and nowhere else.
  const std::vector<std::pair<std::string, std::string>> refused = {
      {"xmlns:xsi=\"http://example.org\"", ""},
      {"xmlns=\"http://example.org\"", ""},
      {"xsi:schemaLocation=\"a b\"", ""},
      {"xsi:nil=\"true\"", ""},
      {"", xsi},
      {"", location}};
  for (const auto& [of_scene, of_surface] : refused) {
    const std::vector<std::string> problems = problems_of(scene(of_scene, of_surface));
    REQUIRE(problems.size() == 1);
    CHECK_THAT(problems[0], contains_text("has no attribute"));
  }
}

}  // namespace
}  // namespace pliant::testing
