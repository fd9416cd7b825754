#include <string>

#include "pliant/scene/elements/read_elements.hpp"
#include "scene/scene_text.hpp"

namespace pliant::testing {
namespace {

TEST_CASE("each kind of force has its own attributes", "[scene][force]") {
  const Scene scene = scene_of(
      scene_with("<point name=\"p\" center=\"1 2 3\" direction=\"0 0 -2\"/>"
                 "<radial name=\"r\" center=\"4 5 6\" falloff=\"gaussian\" enabled=\"false\"/>"
                 "<line name=\"l\" from=\"7 8 9\" to=\"1 0 1\"/>"
                 "<line name=\"m\" direction=\"1 0 0\" falloff=\"linear\"/>"));
  REQUIRE(scene.forces.size() == 4);
  const auto& point = std::get<PointChannels>(scene.forces[0].kind);
  CHECK(point.center.at(1) == Value<3>{1, 2, 3});
  CHECK(point.direction.at(1) == Value<3>{0, 0, -2});
  CHECK(std::get<RadialChannels>(scene.forces[1].kind).center.at(1) == Value<3>{4, 5, 6});
  CHECK(scene.forces[1].falloff == Falloff::Gaussian);
  CHECK_FALSE(scene.forces[1].enabled.at(1));
  const auto& line = std::get<LineChannels>(scene.forces[2].kind);
  CHECK(line.from.at(1) == Value<3>{7, 8, 9});
  CHECK(line.to.at(1) == Value<3>{1, 0, 1});
  CHECK_FALSE(line.direction);
  REQUIRE(std::get<LineChannels>(scene.forces[3].kind).direction);
  CHECK(std::get<LineChannels>(scene.forces[3].kind).direction->at(1) == Value<3>{1, 0, 0});
}

TEST_CASE("every channel of a force can be animated", "[scene][force]") {
  const std::string number = "\"><key frame=\"1\" value=\"2\"/></animate>";
  const std::string vector = "\"><key frame=\"1\" value=\"1 2 3\"/></animate>";
  const Scene scene = scene_of(scene_with(
      "<line name=\"l\"><animate attribute=\"magnitude" + number +
      "<animate attribute=\"deformationRadius" + number + "<animate attribute=\"forceRadius" +
      number + "<animate attribute=\"from" + vector + "<animate attribute=\"to" + vector +
      "<animate attribute=\"direction" + vector +
      "<animate attribute=\"enabled\"><key frame=\"1\" value=\"false\"/></animate></line>"));
  const Force& force = scene.forces.at(0);
  CHECK(force.magnitude.is_animated());
  CHECK(force.deformation_radius.is_animated());
  CHECK(force.force_radius.is_animated());
  CHECK(force.enabled.channel().is_animated());
  const auto& line = std::get<LineChannels>(force.kind);
  CHECK(line.from.is_animated());
  CHECK(line.to.is_animated());
  REQUIRE(line.direction);
  CHECK(line.direction->is_animated());
  CHECK(line.direction->curve().keys().keys.at(0).value == Value<3>{1, 2, 3});
}

std::string falloff(const std::string& keys, const std::string& attributes = "") {
  return force_with("<falloff " + attributes + ">\n" + keys + "</falloff>");
}

TEST_CASE("a falloff is a curve over s", "[scene][falloff]") {
  const Scene scene = scene_of(
      falloff("<key at=\"0.1\" value=\"1\" out=\"-2\"/>"
              "<key at=\"0.5\" value=\"0.25\" interpolation=\"step\"/><key at=\"1\" value=\"-3\"/>",
              "tangent=\"flat\" interpolation=\"linear\" overshoot=\"contain\""));
  REQUIRE(scene.forces.at(0).falloff_curve);
  const Curve<1>& curve = *scene.forces[0].falloff_curve;
  CHECK(curve.value(0)[0] == 1);
  CHECK_THAT(curve.value(0.3)[0], WithinAbs(0.625, 1e-15));  // linear, as given in the element
  CHECK(curve.value(0.75)[0] == 0.25);
  CHECK(curve.value(2)[0] == -3);
  CHECK(curve.keys().overshoot == Overshoot::Contain);
}

TEST_CASE("every kind of force takes a falloff", "[scene][falloff]") {
  const std::string kind =
      GENERATE("point", "radial", "line", "uniform", "vortex", "noise", "inertia", "pressure");
  const Scene scene = scene_of(scene_with(
      "<" + kind + " name=\"f\"><falloff><key at=\"0\" value=\"2\"/></falloff></" + kind + ">"));
  CHECK(scene.forces.at(0).falloff_curve);
}

TEST_CASE("what is wrong with a falloff is told", "[scene][falloff]") {
  const std::string key = "<key at=\"0\" value=\"1\"/>\n";
  check_each({
      {falloff(key + "<key at=\"1.5\" value=\"0\"/>"),
       5,
       {"<key> at=\"1.5\": must be from 0 to 1"}},
      {falloff("<key at=\"-0.1\" value=\"0\"/>"), 4, {"must be from 0 to 1"}},
      {falloff(key + "<key at=\"0\" value=\"0\"/>"), 5, {"<key> at 0 repeats the key of line 4"}},
      {falloff("<key at=\"0.5\" value=\"0\"/>\n" + key), 5, {"<key> at 0 is not after at 0.5"}},
      {falloff("<key frame=\"0.5\" at=\"0\" value=\"0\"/>"), 4, {"no attribute \"frame\""}},
      {falloff("<key at=\"0.5\"/>"), 4, {"<key> needs the attribute \"value\""}},
      {falloff("<key at=\"nan\" value=\"1\"/>"), 4, {"not a finite number"}},
      {falloff(""), 3, {"<falloff> has no keys"}},
      {falloff(key, "after=\"repeat\""), 3, {"<falloff> has no attribute \"after\""}},
      {falloff(key + "<loop from=\"0\" to=\"1\"/>"), 5, {"<falloff> has no element \"loop\""}},
      {force_with("<falloff>" + key + "</falloff><falloff>" + key + "</falloff>"),
       4,
       {"<point> has a second <falloff>; the first is at line 3"}},
      {scene_with("<point name=\"p\" falloff=\"linear\">\n<falloff>" + key + "</falloff></point>"),
       3,
       {"has both a <falloff> and the attribute falloff (line 2); remove one of them"}},
      {surface_with("<material><falloff/></material>"), 3, {"it belongs in <point> or <radial>"}},
      {animate_with("", "<key frame=\"1\" at=\"0\" value=\"1\"/>"), 4, {"no attribute \"at\""}},
  });
}

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
  CHECK(scene.origin.place_of("p").line == 3);
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
       {"<group> has no attribute \"forceRadius\"", "name, enabled, targets, follow, center"}},
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
