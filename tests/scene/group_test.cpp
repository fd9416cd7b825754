#include "pliant/scene/group.hpp"

#include <string>

#include "scene/scene_text.hpp"

namespace pliant::testing {
namespace {

std::string sheets(const std::string& body) {
  const std::string grid = "<grid columns=\"3\" rows=\"3\"/></surface>";
  return scene_with("<surface name=\"a\">" + grid + "<surface name=\"b\">" + grid + '\n' + body);
}

TEST_CASE("a group holds forces of every kind, which stand among all others", "[scene][group]") {
  const Scene scene = scene_of(
      sheets("<point name=\"before\"/>"
             "<group name=\"hand\" center=\"1 2 3\" deformationRadius=\"4\" targets=\"a\">"
             "<point name=\"p\"/><radial name=\"r\"/><line name=\"l\"/><uniform name=\"u\"/>"
             "<vortex name=\"v\"/><noise name=\"n\"/><inertia name=\"i\"/></group>"
             "<point name=\"after\" deformationRadius=\"2\"/>"));
  REQUIRE(scene.groups.size() == 1);
  CHECK(scene.groups[0].name == "hand");
  CHECK(scene.groups[0].center.at(1) == Value<3>{1, 2, 3});
  CHECK(scene.groups[0].deformation_radius.at(1)[0] == 4);
  CHECK(scene.groups[0].targets == std::vector<std::string>{"a"});
  std::string order;
  for (const Force& force : scene.forces) {
    order += force.name + (force.group.empty() ? ". " : "! ");
    CHECK((force.group.empty() || force.group == "hand"));
  }
  CHECK(order == "before. p! r! l! u! v! n! i! after. ");
  CHECK(scene.origin.line_of("p") == 3);
}

TEST_CASE("what is wrong in a group is told", "[scene][group]") {
  check_each({
      {scene_with("<group name=\"g\">\n<point name=\"p\"\n deformationRadius=\"2\"/></group>"),
       4,
       {"<point> deformationRadius: a force in a <group> must not have one"}},
      {scene_with("<group name=\"g\">\n<line name=\"l\">\n<animate attribute=\"deformationRadius\">"
                  "<key frame=\"1\" value=\"2\"/></animate></line></group>"),
       4,
       {"<line> deformationRadius: a force in a <group> must not have one"}},
      {scene_with("<group name=\"g\">\n<group name=\"h\"/></group>"),
       3,
       {"<group> has no element \"group\"; it belongs in <scene>; allowed: animate, path, point"}},
      {scene_with("<group name=\"g\">\n<point name=\"g\"/></group>"),
       3,
       {"<point> name=\"g\": the name is already used at line 2"}},
      {scene_with("<group name=\"g\"><point name=\"p\"/></group>\n<radial name=\"p\"/>"),
       3,
       {"the name is already used at line 2"}},
      {scene_with("<group name=\"g\" forceRadius=\"1\"/>"),
       2,
       {"<group> has no attribute \"forceRadius\"", "name, enabled, targets, center"}},
      {scene_with("<group name=\"g\" deformationRadius=\"-1\"/>"), 2, {"must be at least 0"}},
      {scene_with("<group/>"), 2, {"<group> needs the attribute \"name\""}},
      {sheets("<group name=\"g\" targets=\"bb\"/>"),
       3,
       {"g.targets: no surface is named \"bb\"; allowed: a, b"}},
      {sheets("<group name=\"g\">\n<point name=\"p\" targets=\"g\"/></group>"),
       4,
       {"p.targets: \"g\" is a <group>, not a surface"}},
      {scene_with("<group name=\"g\">\n<pointt name=\"p\"/></group>"),
       3,
       {"did you mean \"point\"?"}},
  });
}

TEST_CASE("a target that the group has not is noted", "[scene][group]") {
  const Scene scene = scene_of(
      sheets("<group name=\"g\" targets=\"a\">\n<point name=\"p\" targets=\"a b\"/></group>"));
  REQUIRE(scene.notes.size() == 1);
  CHECK(scene.notes[0].line == 4);
  CHECK(scene.notes[0].message ==
        "p.targets: \"b\" is not a target of the group \"g\": the force has no effect there");
}

}  // namespace
}  // namespace pliant::testing
