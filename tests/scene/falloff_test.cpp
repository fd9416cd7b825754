#include "pliant/scene/falloff.hpp"

#include <string>

#include "scene/scene_text.hpp"

namespace pliant::testing {
namespace {

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
      GENERATE("point", "radial", "line", "uniform", "vortex", "noise", "inertia");
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

}  // namespace
}  // namespace pliant::testing
