#include "pliant/scene/checks/rules.hpp"

#include <string>

#include "scene/scene_text.hpp"

namespace pliant::testing {
namespace {

TEST_CASE("each rule between values is told where the last of them stands", "[scene][checks]") {
  check_each({
      {"<scene start=\"5\"\n end=\"4\"/>",
       2,
       {"end is 4, but must not be before start, which is 5"}},
      {"<scene start=\"1\"\n end=\"1000001\"/>", 2, {"1000001 frames", "at most 1000000"}},
      {"<scene start=\"-1000000000\" end=\"1000000000\"/>", 1, {"2000000001 frames"}},
      {scene_with("<surface name=\"s\">\n<grid\n columns=\"10001\"\n rows=\"10000\"/></surface>"),
       5,
       {"10001 x 10000 = 100010000 vertices", "at most 100000000"}},
      {surface_with("<material b=\"4\"\n c=\"-4\"\n d=\"1\"/>"),
       5,
       {"sheet.c is -4", "greater than -2 sqrt(b d) = -4", "b = 4", "d = 1"}},
      {surface_with("<material b=\"2\" c=\"-4\" d=\"2\"/>"), 3, {"-2 sqrt(b d) = -4"}},
      {surface_with("<material b=\"1e-300\" d=\"1e-300\" c=\"-1\"/>"), 3, {"-2 sqrt(b d)"}},
      {surface_with("<solver dt=\"4e-7\"/>"), 3, {"104167 steps in a frame", "at most 100000"}},
      {"<scene start=\"1\" end=\"2\" fps=\"1e-4\">\n<surface name=\"s\"><grid columns=\"3\" "
       "rows=\"3\"/></surface></scene>",
       2,
       {"in a frame of 10000 s"}},
      {scene_with("<point name=\"p\"/>\n<radial\n name=\"p\"/>"),
       4,
       {"<radial> name=\"p\"", "already used at line 2"}},
      {scene_with(
           "<surface name=\"p\"><grid columns=\"3\" rows=\"3\"/></surface>\n<line name=\"p\"/>"),
       3,
       {"<line> name=\"p\"", "already used at line 2"}},
      {surface_with("").replace(surface_with("").find("</scene>"), 8,
                                "<point name=\"p\"\n targets=\"shet\"/></scene>"),
       5,
       {"p.targets: no surface is named \"shet\"; did you mean \"sheet\"? allowed: sheet"}},
      {scene_with("<point name=\"p\" targets=\"sheet\"/>"),
       2,
       {"no surface is named", "allowed: none"}},
      {scene_with("<point name=\"p\"/>\n<line name=\"l\" targets=\"p\"/>"),
       3,
       {"l.targets: \"p\" is a <point>, not a surface"}},
  });
}

TEST_CASE("the limits themselves are allowed", "[scene][checks]") {
  for (const std::string& text :
       {std::string("<scene start=\"1\" end=\"1000000\"/>"),
        std::string("<scene start=\"4\" end=\"4\"/>"),
        scene_with("<surface name=\"s\"><grid columns=\"10000\" rows=\"10000\"/></surface>"),
        std::string(
            "<scene start=\"1\" end=\"2\" fps=\"10\"><surface name=\"s\"><grid columns=\"3\" "
            "rows=\"3\"/><solver dt=\"1e-6\"/></surface></scene>"),
        surface_with("<material b=\"1e300\" d=\"1e300\" c=\"-1e300\"/>")}) {
    CAPTURE(text);
    CHECK(problems_of(text).empty());
  }
}

TEST_CASE("what is animated is left to the frames", "[scene][checks]") {
  CHECK(problems_of(surface_with("<material c=\"-5\"><animate attribute=\"b\"><key frame=\"1\" "
                                 "value=\"9\"/></animate></material>"))
            .empty());
  CHECK(problems_of(surface_with("<solver><animate attribute=\"dt\"><key frame=\"1\" "
                                 "value=\"1e-9\"/></animate></solver>"))
            .empty());
}

TEST_CASE("targets may name a surface that comes later", "[scene][checks]") {
  const Scene scene =
      scene_of(scene_with("<point name=\"p\" targets=\"b a\"/><surface name=\"a\"><grid "
                          "columns=\"3\" rows=\"3\"/></surface>"
                          "<surface name=\"b\"><grid columns=\"3\" rows=\"3\"/></surface>"));
  CHECK(scene.forces.at(0).targets == std::vector<std::string>{"b", "a"});
}

}  // namespace
}  // namespace pliant::testing
