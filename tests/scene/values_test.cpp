#include <string>
#include <vector>

#include "scene/scene_text.hpp"

namespace pliant::testing {
namespace {

std::string scene_tag(const std::string& attributes) {
  return "<scene start=\"1\"\n end=\"96\"\n " + attributes + "/>";
}

std::string grid(const std::string& attributes) {
  return scene_with("<surface name=\"s\">\n<grid " + attributes + "/></surface>");
}

std::string mesh(const std::string& attributes) {
  return scene_with("<surface name=\"s\">\n<mesh " + attributes + "/></surface>");
}

std::string part(const std::string& element, const std::string& attributes) {
  return surface_with("<" + element + ' ' + attributes + "/>");
}

std::string point(const std::string& attributes) {
  return scene_with("<point name=\"p\" " + attributes + "/>");
}

TEST_CASE("each value out of its range is told with the rule", "[scene][values]") {
  check_each({
      {scene_tag("version=\"2\""),
       3,
       {"version=\"2\"", "reads version 1", "not supported by this version"}},
      {scene_tag("version=\"0\""), 3, {"version=\"0\": must be at least 1"}},
      {scene_tag("version=\"1.0\""), 3, {"version=\"1.0\": not a whole number"}},
      {scene_tag("fps=\"0\""), 3, {"fps=\"0\": must be greater than 0"}},
      {scene_tag("fps=\"-24\""), 3, {"greater than 0"}},
      {scene_tag("fps=\"24/0\""), 3, {"fraction"}},
      {scene_tag("fps=\"24 fps\""), 3, {"fps=\"24 fps\": not a number"}},
      {scene_tag("seed=\"-1\""), 3, {"seed=\"-1\": must be at least 0"}},
      {scene_tag("seed=\"1.5\""), 3, {"not a whole number"}},
      {scene_tag("seed=\"18446744073709551616\""), 3, {"outside the range"}},
      {"<scene start=\"1.5\" end=\"9\"/>", 1, {"start=\"1.5\": not a whole number"}},
      {"<scene start=\"1\" end=\"1e2\"/>", 1, {"end=\"1e2\": not a whole number"}},
      {"<scene start=\"1\" end=\"1000000001\"/>", 1, {"must be at most 1000000000"}},
      {"<scene start=\"-1000000001\" end=\"1\"/>", 1, {"must be at least -1000000000"}},
      {grid("columns=\"2\" rows=\"3\""), 3, {"columns=\"2\": must be at least 3"}},
      {grid("columns=\"3\" rows=\"-3\""), 3, {"rows=\"-3\": must be at least 3"}},
      {grid("columns=\"3.0\" rows=\"3\""), 3, {"columns=\"3.0\": not a whole number"}},
      {grid("columns=\"100000001\" rows=\"3\""), 3, {"must be at most 100000000"}},
      {grid("columns=\"3\" rows=\"3\" width=\"0\""), 3, {"width=\"0\": must be greater than 0"}},
      {grid("columns=\"3\" rows=\"3\" depth=\"-1\""), 3, {"depth=\"-1\": must be greater than 0"}},
      {grid("columns=\"3\" rows=\"3\" width=\"1,5\""), 3, {"width=\"1,5\": not a number"}},
      {grid("columns=\"3\" rows=\"3\" faces=\"tris\""),
       3,
       {"faces=\"tris\": unknown word", "quads, triangles"}},
      {mesh("file=\"\""), 3, {"is empty; the name of a file"}},
      {mesh("file=\"/etc/passwd\" object=\"\""), 3, {"is empty; leave the attribute out"}},
      {mesh("file=\"/etc/passwd\" uvSet=\"-1\""), 3, {"must be at least 0"}},
      {mesh("file=\"/etc/passwd\" uvSet=\"8\""), 3, {"must be at most 7"}},
      {mesh("file=\"/etc/passwd\" uv=\"gird\""), 3, {"did you mean \"grid\"?"}},
      {mesh("file=\"/etc/passwd\" wrap=\"w\""), 3, {"unknown word; allowed: none, u, v, uv"}},
      {part("transform", "translate=\"0 0\""), 3, {"three numbers are required, not 2"}},
      {part("transform", "rotate=\"0 0 inf\""), 3, {"not a finite number"}},
      {part("transform", "scale=\"1 0 1\""),
       3,
       {"scale=\"1 0 1\": each number must differ from 0"}},
      {part("transform", "scale=\"2\""), 3, {"three numbers are required, not 1"}},
      {part("transform", "rotateOrder=\"xxz\""),
       3,
       {"unknown word", "xyz, xzy, yxz, yzx, zxy, zyx"}},
      {part("material", "density=\"-1\""), 3, {"density=\"-1\": must be at least 0"}},
      {part("material", "damping=\"-0.5\""), 3, {"damping=\"-0.5\": must be at least 0"}},
      {part("material", "b=\"0\""), 3, {"b=\"0\": must be greater than 0"}},
      {part("material", "d=\"-1\""), 3, {"d=\"-1\": must be greater than 0"}},
      {part("material", "c=\"1.5abc\""), 3, {"\"abc\" follows 1.5"}},
      {part("tangents", "su0=\"0 1\""), 3, {"one or three numbers are required"}},
      {part("tangents", "sv1=\"up\""), 3, {"sv1=\"up\": not a number"}},
      {part("solver", "dt=\"0\""), 3, {"dt=\"0\": must be greater than 0"}},
      {part("solver", "dt=\"nan\""), 3, {"not a finite number"}},
      {part("solver", "startFrame=\"1.5\""), 3, {"not a whole number"}},
      {part("solver", "stepping=\"exakt\""), 3, {"did you mean \"exact\"?"}},
      {part("solver", "reference=\"res\""), 3, {"did you mean \"rest\"?"}},
      {part("solver", "measure=\"curent\""), 3, {"did you mean \"current\"?"}},
      {part("solver", "combine=\"boxes\""), 3, {"unknown word", "allowed: box, islands, union"}},
      {part("solver", "release=\"freze\""), 3, {"did you mean \"freeze\"?"}},
      {part("solver", "integrator=\"rk4\""), 3, {"allowed: backwardEuler"}},
      {part("solver", "region=\"force\""), 3, {"did you mean \"forces\"?"}},
      {point("deformationRadius=\"-1\""), 2, {"must be at least 0"}},
      {point("forceRadius=\"-1\""), 2, {"must be at least 0"}},
      {point("magnitude=\"0x10\""), 2, {"magnitude=\"0x10\": not a number"}},
      {point("enabled=\"1\""), 2, {"enabled=\"1\": must be true or false"}},
      {point("falloff=\"smoth\""),
       2,
       {"did you mean \"smooth\"?", "constant, linear, smooth, gaussian"}},
      {point("center=\"1 2 3 4\""), 2, {"three numbers are required, not 4"}},
      {point("direction=\"\""), 2, {"is empty"}},
      {scene_with("<point name=\"2p\"/>"), 2, {"name=\"2p\"", "must be a letter or _"}},
      {scene_with("<point name=\"\"/>"), 2, {"name=\"\"", "must be a letter or _"}},
      {scene_with("<surface name=\"a b\"><grid columns=\"3\" rows=\"3\"/></surface>"),
       2,
       {"\"a b\""}},
      {scene_with("<surface name=\"a\" enabled=\"no\"><grid columns=\"3\" rows=\"3\"/></surface>"),
       2,
       {"must be true or false"}},
  });
}

TEST_CASE("values at the edge of their range are read", "[scene][values]") {
  for (const std::string& text :
       {grid("columns=\"3\" rows=\"3\" width=\"5e-324\""),
        part("material", "density=\"0\" damping=\"0\""),
        point("deformationRadius=\"0\" forceRadius=\"0\" magnitude=\"-1e308\""),
        part("transform", "scale=\"-1 1e-300 1\""), part("material", "c=\"-1.9999999\""),
        std::string("<scene start=\"-1000000000\" end=\"-1000000000\"/>"),
        scene_tag("seed=\"18446744073709551615\"")}) {
    CAPTURE(text);
    CHECK(problems_of(text).empty());
  }
}

}  // namespace
}  // namespace pliant::testing
