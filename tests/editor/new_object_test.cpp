#include "editor/new_object.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "pliant/scene/format/format.hpp"
#include "support/catch.hpp"

using namespace pliant;
using editor::NewObject;
using editor::to_add;
using pliant::testing::contains_text;

namespace {

SceneDocument document_of(const std::string& content) {
  return *SceneDocument::from_text(
      "<scene version=\"1\" start=\"1\" end=\"80\">" + content + "</scene>", "scene.xml", "");
}

const std::string square =
    "<surface name=\"sheet\"><grid columns=\"25\" rows=\"25\" width=\"6\" depth=\"6\"/>"
    "<transform translate=\"10 2 -5\" rotate=\"90 0 0\"/></surface>";

double peak_of(const Scene& scene) {
  const auto simulation = Simulation::make(scene);
  REQUIRE(simulation);
  const auto played = play_forces(*simulation, 0, std::numeric_limits<double>::infinity());
  REQUIRE(played);
  return played->peak;
}

}  // namespace

TEST_CASE("a new force moves the surface by a tenth of its size", "[editor][new_object]") {
  for (const std::string& region : {std::string(), std::string("all")}) {
    std::string surface = square;
    if (!region.empty())
      surface.insert(surface.find("</surface>"), "<solver region=\"all\" integrator=\"newmark\"/>");
    for (const char* kind : {"point", "radial", "line", "uniform", "noise", "pressure", "vortex"}) {
      SceneDocument document = document_of(surface);
      const auto addition = to_add(document, {.kind = kind}, {});
      REQUIRE(addition);
      CHECK(addition->name == kind);
      REQUIRE(document.apply(addition->operations));
      CAPTURE(kind, region);
      // The numbers have two or three digits, and a whole surface may leave the reach of a force.
      const double miss = region.empty() ? 0.06 : 0.2;
      CHECK_THAT(peak_of(document.scene()),
                 Catch::Matchers::WithinRel(0.1 * 6 * std::sqrt(2), miss));
    }
  }
}

TEST_CASE("a new force stands at the middle of its surface", "[editor][new_object]") {
  SceneDocument document = document_of(square);
  REQUIRE(document.apply(to_add(document, {.kind = "grid"}, {})->operations));
  REQUIRE(document.scene().surfaces.size() == 2);
  const std::vector<Surface> surfaces = document.scene().surfaces;
  for (const Surface& surface : surfaces) {
    const auto addition = to_add(document, {.kind = "point", .surface = surface.name}, {});
    REQUIRE(addition);
    REQUIRE(document.apply(addition->operations));
    const Force& force = document.scene().forces.back();
    CHECK(force.targets == std::vector{surface.name});
    const Value<3> center = std::get<PointChannels>(force.kind).center.at(1);
    const Placement placement = surface.transform.placement_at(1);
    for (int k = 0; k < 3; ++k)
      CHECK_THAT(center[k], Catch::Matchers::WithinAbs(placement.translate[k], 0.02));
  }
}

TEST_CASE("whatever the format has can be added, twice", "[editor][new_object]") {
  std::vector<std::string_view> solids;
  for (const ChildFormat& child : find_format(scene_format(), "collider")->children)
    if (child.is_choice()) solids = child.names;
  std::erase(solids, "mesh");  // which is a surface
  REQUIRE(solids.size() >= 4);
  for (const std::string& content : {std::string(), square}) {
    for (const ElementFormat& element : scene_format()) {
      const auto name = std::ranges::find(element.attributes, "name", &AttributeFormat::name);
      const bool is_object = std::ranges::find(element.parents, "scene") != element.parents.end() &&
                             name != element.attributes.end() && name->type == "name";
      const bool is_solid = std::ranges::find(solids, element.name) != solids.end();
      const bool is_made = element.name != "surface" && element.name != "collider";
      if (!(is_object && is_made) && !is_solid && element.name != "grid") continue;
      SceneDocument document = document_of(content);
      for (int k = 0; k < 2; ++k) {
        CAPTURE(element.name, content);
        const auto addition = to_add(document, {.kind = std::string(element.name)}, {});
        REQUIRE(addition);
        REQUIRE(document.apply(addition->operations));
        CHECK_THAT(document.text(), contains_text("name=\"" + addition->name + "\""));
      }
    }
  }
}

TEST_CASE("what cannot be added is told", "[editor][new_object]") {
  const SceneDocument document = document_of(square);
  for (const auto& [kind, reason] :
       {std::pair("nothing", "nothing"), std::pair("scene", "scene"),
        std::pair("material", "material"), std::pair("surface", "surface"),
        std::pair("collider", "collider"), std::pair("mesh", "file")}) {
    const auto addition = to_add(document, {.kind = kind}, {});
    REQUIRE_FALSE(addition);
    CHECK_THAT(addition.error().message, contains_text(reason));
  }
}
