#include "pliant/scene/elements/element.hpp"

#include <string>
#include <vector>

#include "scene/scene_text.hpp"

namespace pliant::testing {
namespace {

TEST_CASE("a word that the format does not know is told with the nearest and all allowed",
          "[scene][element]") {
  check_each({
      {scene_with("<radial name=\"r\" falof=\"smooth\"/>"),
       2,
       {"<radial> has no attribute \"falof\"; did you mean \"falloff\"? allowed: name, enabled, "
        "targets, magnitude, deformationRadius, forceRadius, falloff, follow, "
        "center"}},
      {scene_with("<radial name=\"r\"\n\n direction=\"0 1 0\"/>"),
       4,
       {"<radial> has no attribute \"direction\"; allowed: "}},
      {scene_with("<rdial name=\"r\"/>"),
       2,
       {"<scene> has no element \"rdial\"; did you mean \"radial\"? allowed: surface, point, "
        "radial, line"}},
      {scene_with("<potato/>"), 2, {"<scene> has no element \"potato\"; allowed: surface, point"}},
      {surface_with("<grid2/>"), 3, {"<surface> has no element \"grid2\"", "allowed: grid, mesh"}},
      {surface_with("<solver><key/></solver>"),
       3,
       {"<solver> has no element \"key\"; it belongs in <animate> or <falloff>; allowed: animate"}},
      {scene_with("<grid columns=\"3\" rows=\"3\"/>"),
       2,
       {"<scene> has no element \"grid\"; it belongs in <surface>; allowed: surface"}},
      {animate_with("", "<key frame=\"1\" value=\"1\"><key/></key>"),
       4,
       {"<key> has no element \"key\"", "allowed: none"}},
      {"<scene start=\"1\" end=\"2\" fsp=\"25\"/>",
       1,
       {"no attribute \"fsp\"; did you mean \"fps\"?"}},
  });
}

TEST_CASE("what a later version brings is not taken for a misspelling", "[scene][element]") {
  const std::string later = "is not supported by this version of pliant";
  std::vector<BadScene> scenes;
  for (const std::string given : {"uv=\"virtual\"", "resolution=\"9\""})
    scenes.push_back(
        {scene_with("<surface name=\"s\"><mesh file=\"/etc/passwd\" " + given + "/></surface>"),
         2,
         {given.substr(0, given.find('=')), later}});
  check_each(scenes);
}

TEST_CASE("an attribute that is needed and missing is told at its element", "[scene][element]") {
  check_each({
      {"<scene\n end=\"2\"/>", 1, {"<scene> needs the attribute \"start\""}},
      {"<scene start=\"2\"/>", 1, {"<scene> needs the attribute \"end\""}},
      {scene_with("<point/>"), 2, {"<point> needs the attribute \"name\""}},
      {scene_with("<surface><grid columns=\"3\" rows=\"3\"/></surface>"),
       2,
       {"<surface> needs the attribute \"name\""}},
      {scene_with("<surface name=\"s\">\n<grid rows=\"3\"/></surface>"), 3, {"\"columns\""}},
      {scene_with("<surface name=\"s\">\n<grid columns=\"3\"/></surface>"), 3, {"\"rows\""}},
      {scene_with("<surface name=\"s\">\n<mesh/></surface>"), 3, {"<mesh> needs", "\"file\""}},
      {force_with("<animate><key frame=\"1\" value=\"1\"/></animate>"),
       3,
       {"<animate> needs the attribute \"attribute\""}},
      {animate_with("", "<key value=\"1\"/>"), 4, {"<key> needs the attribute \"frame\""}},
      {animate_with("", "<key frame=\"1\"/>"), 4, {"<key> needs the attribute \"value\""}},
      {animate_with("", "<key frame=\"1\" value=\"1\"/>\n<loop to=\"3\"/>"),
       5,
       {"<loop> needs", "\"from\""}},
      {animate_with("", "<key frame=\"1\" value=\"1\"/>\n<loop from=\"1\"/>"),
       5,
       {"<loop> needs", "\"to\""}},
  });
}

TEST_CASE("text belongs nowhere", "[scene][element]") {
  check_each({
      {scene_with("hello"), 2, {"<scene> contains the text \"hello\"; no text is allowed here"}},
      {surface_with("<material>40</material>"), 3, {"<material> contains the text \"40\""}},
      {force_with("\n<![CDATA[x]]>"), 4, {"<point> contains the text \"x\""}},
      {animate_with("", "<key frame=\"1\" value=\"1\">2</key>"),
       4,
       {"<key> contains the text \"2\""}},
      {scene_with("<radial name=\"r\">z</radial>"), 2, {"<radial> contains the text"}},
  });
}

TEST_CASE("one mistake is told once", "[scene][element]") {
  // Each of these would cause a second complaint if an unknown value counted as absent.
  check_each({
      {scene_with("<point nam=\"poke\"/>"), 2, {"\"nam\"; did you mean \"name\"?"}},
      {scene_with("<surface nme=\"s\"><grid columns=\"3\" rows=\"3\"/></surface>\n"
                  "<point name=\"p\" targets=\"s\"/>"),
       2,
       {"\"nme\""}},
      {scene_with("<surface name=\"s\">\n<gird columns=\"3\" rows=\"3\"/></surface>"),
       3,
       {"\"gird\""}},
      {scene_with("<surfac name=\"s\"/>\n<point name=\"p\" targets=\"s\"/>"), 2, {"\"surfac\""}},
      {scene_with("<group name=\"g\"/>\n<point name=\"p\" targets=\"g\"/>"),
       3,
       {"\"g\" is a <group>"}},
      {animate_with("", "<ky frame=\"1\" value=\"2\"/>"), 4, {"\"ky\"; did you mean \"key\"?"}},
      {surface_with("<material b=\"-1\" c=\"-5\"/>"), 3, {"b=\"-1\": must be greater than 0"}},
      {"<scene start=\"x\" end=\"-5\"/>", 1, {"start=\"x\""}},
      {"<scene start=\"1\" end=\"2\" fps=\"0\">\n<surface name=\"s\"><grid columns=\"3\" "
       "rows=\"3\"/><solver dt=\"1e-12\"/></surface></scene>",
       1,
       {"fps=\"0\""}},
  });
}

}  // namespace
}  // namespace pliant::testing
