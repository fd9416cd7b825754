#include <string>

#include "pliant/scene/elements/read_elements.hpp"
#include "scene/scene_text.hpp"

namespace pliant::testing {
namespace {

const std::string corner =
    "<waypoint at=\"0 0 0\"/>\n<waypoint at=\"1 0 0\"/>\n<waypoint at=\"1 1 0\"/>\n";

std::string path(const std::string& attributes, const std::string& children) {
  return force_with("<path " + attributes + ">\n" + children + "</path>");
}

std::string progress(const std::string& keys) {
  return "<animate attribute=\"progress\">" + keys + "</animate>";
}

TEST_CASE("a position may follow a path", "[scene][path]") {
  const Scene scene = scene_of(scene_with(
      "<line name=\"l\"><path attribute=\"to\" progress=\"0.5\">" + corner + "</path></line>" +
      "<vortex name=\"v\"><path attribute=\"center\" closed=\"true\">" + corner +
      progress("<key frame=\"1\" value=\"0\"/><key frame=\"9\" value=\"1\"/>") +
      "</path></vortex><group name=\"g\"><path attribute=\"center\">" + corner +
      "</path></group>"));
  const auto& line = std::get<LineChannels>(scene.forces.at(0).kind);
  CHECK(line.from.path() == nullptr);
  REQUIRE(line.to.path());
  CHECK_FALSE(line.to.is_animated());
  CHECK_THAT(line.to.at(1)[0], WithinAbs(1, 1e-9));  // half of a path of two equally long parts
  const auto& vortex = std::get<VortexChannels>(scene.forces.at(1).kind);
  REQUIRE(vortex.center.path());
  CHECK(vortex.center.is_animated());
  CHECK(vortex.center.path()->path.is_closed());
  CHECK(vortex.center.at(9) == Value<3>{0, 0, 0});
  CHECK(scene.groups.at(0).center.path());
}

TEST_CASE("what is wrong with a path is told", "[scene][path]") {
  const std::string center = "attribute=\"center\"";
  check_each({
      {path("", corner), 3, {"<path> needs the attribute \"attribute\""}},
      {path("attribute=\"centre\"", corner),
       3,
       {"<point> has no such position; did you mean \"center\"? allowed: center"}},
      {path("attribute=\"direction\"", corner),
       3,
       {"is not a position; the positions of <point> are: center"}},
      {path(center, "<waypoint at=\"0 0 0\"/>\n<waypoint at=\"1 0 0\"/>"),
       3,
       {"<path> has 2 waypoints; a path must have at least three waypoints"}},
      {path(center, ""), 3, {"<path> has 0 waypoints"}},
      {path(center, corner + "<waypoint at=\"1 1 0\"/>"),
       7,
       {"<waypoint> 4 is at the same position as the one before"}},
      {path(center + " closed=\"true\"", corner + "<waypoint at=\"0 0 0\"/>"),
       4,
       {"<waypoint> 1 is at the same position as the last one"}},
      {path(center, corner + "<waypoint at=\"1 1\"/>"), 7, {"three numbers are required, not 2"}},
      {path(center, corner + "<waypoint/>"), 7, {"<waypoint> needs the attribute \"at\""}},
      {path(center, corner + "<point at=\"1 2 3\"/>"), 7, {"<path> has no element \"point\""}},
      {path(center + " progress=\"1.5\"", corner), 3, {"progress=\"1.5\": must be from 0 to 1"}},
      {path(center + " closed=\"yes\"", corner), 3, {"closed=\"yes\": must be true or false"}},
      {path(center + " progress=\"1\"", corner + progress("<key frame=\"1\" value=\"0\"/>")),
       7,
       {"is already given (line 3)"}},
      {path(center,
            corner + "<animate attribute=\"closed\"><key frame=\"1\" value=\"1\"/></animate>"),
       7,
       {"cannot be animated; the channels of <path> are: progress"}},
      {scene_with("<point name=\"p\" center=\"0 0 0\">\n<path " + center + ">" + corner +
                  "</path></point>"),
       3,
       {"<path> attribute=\"center\": is already given (line 2); remove one of them"}},
      {scene_with("<point name=\"p\"><path " + center + ">" + corner + "</path>" + "<animate " +
                  center + "><key frame=\"1\" value=\"0 0 0\"/></animate></point>"),
       5,
       {"<animate> attribute=\"center\": is already animated (line 2)"}},
      {scene_with("<point name=\"p\"><path " + center + ">" + corner + "</path><path " + center +
                  ">" + corner + "</path></point>"),
       5,
       {"<path> attribute=\"center\": is already animated (line 2)"}},
      {scene_with("<uniform name=\"u\">\n<path " + center + ">" + corner + "</path></uniform>"),
       3,
       {"<uniform> has no element \"path\"; it belongs in <point>"}},
      {surface_with("<path/>"), 3, {"it belongs in <point> or <radial> or <line>"}},
  });
}

TEST_CASE("notes and lines of a progress name it", "[scene][path]") {
  const Scene scene = scene_of(path(
      "attribute=\"center\"", corner + progress("<key frame=\"1\" value=\"0\" outLength=\"-1\"/>"
                                                "<key frame=\"9\" value=\"1\"/>")));
  REQUIRE(scene.notes.size() == 1);
  CHECK_THAT(scene.notes[0].message, contains_text("poke.center.progress: key 1: "));
  CHECK(scene.origin.place_of("poke", "center.progress").line == 7);
}

}  // namespace
}  // namespace pliant::testing
