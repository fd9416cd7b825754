#include <string>

#include "pliant/mesh/written/nurbs_net.hpp"
#include "scene/scene_text.hpp"

namespace pliant::testing {
namespace {

const std::string points =
    "<points>0 0 0 1 0 0 2 0 0  0 0 1 1 0 1 2 0 1  0 0 2 1 0 2 2 0 2</points>";

// A net of 3 x 3 points in line 2; `children` begin in line 3.
std::string net_with(const std::string& children, const std::string& attributes = "",
                     const std::string& degrees = "degreeU=\"2\" degreeV=\"1\"") {
  return scene_with("<surface name=\"s\"><nurbs columns=\"3\" rows=\"3\" " + degrees + " " +
                    attributes + ">\n" + children + "</nurbs></surface>");
}

TEST_CASE("a net is read with its numbers", "[scene][net]") {
  const Scene scene = scene_of(net_with("<knots along=\"v\">0 0\n1 <!-- between --> 3e0 3</knots>" +
                                            points + "<weights>1 1 1 1 2.5 1 1 1 1</weights>",
                                        "samplesU=\"7\""));
  const auto& net = std::get<NurbsNet>(scene.surfaces.at(0).shape);
  CHECK(net.u.count == 3);
  CHECK(net.u.degree == 2);
  CHECK(net.u.samples == 7);
  CHECK_FALSE(net.v.samples);
  CHECK(net.u.knots.empty());
  CHECK(net.v.knots == std::vector<double>{0, 0, 1, 3, 3});
  CHECK(net.weights[4] == 2.5);
  REQUIRE(net.points.rows() == 9);
  CHECK(net.points.row(5) == Eigen::RowVector3d(2, 0, 1));
}

TEST_CASE("wrap closes the directions of a net", "[scene][net]") {
  for (const std::string wrap : {"none", "u", "v", "uv"}) {
    const Scene scene = scene_of(net_with(points, "wrap=\"" + wrap + "\""));
    const auto& net = std::get<NurbsNet>(scene.surfaces.at(0).shape);
    CHECK(net.u.is_closed == (wrap == "u" || wrap == "uv"));
    CHECK(net.v.is_closed == (wrap == "v" || wrap == "uv"));
  }
}

TEST_CASE("a wrong net has its line", "[scene][net]") {
  check_each({
      {net_with(""), 2, {"<nurbs> needs the element <points>"}},
      {net_with("<pionts>0</pionts>"), 3, {"no element \"pionts\"", "\"points\"?"}},
      {net_with("<points>\n0 0 0\n 1,5 0 0</points>"), 5, {"<points> number 4, \"1,5\""}},
      {net_with("<points>0 0 0 1</points>"), 3, {"<points> has 4 numbers", "three"}},
      {net_with("<points>0 0 0</points>"), 3, {"there are 1 points", "9 are needed"}},
      {net_with("<points/>"), 3, {"<points> has no numbers"}},
      {net_with("<points><key/></points>"), 3, {"<points> has no element \"key\""}},
      {net_with(points + "\n" + points), 4, {"second <points>", "first is at line 3"}},
      {net_with(points + "\n<weights>1 1 1 1 0 1 1 1 1</weights>"), 4, {"weight 5 is 0"}},
      {net_with(points + "\n<weights unit=\"m\">1 1 1 1 1 1 1 1 1</weights>"),
       4,
       {"<weights> has no attribute \"unit\""}},
      {net_with(points + "\n<knots along=\"u\">0 0 0 1 1</knots>"), 4, {"there are 5 numbers"}},
      {net_with(points + "\n<knots along=\"u\">0 0 0 1 1 1</knots>\n"
                         "<knots along=\"u\">0 0 0 1 1 1</knots>"),
       5,
       {"second <knots>", "line 4"}},
      {net_with(points + "\n<knots along=\"w\">0</knots>"), 4, {"unknown word", "u, v"}},
      {net_with(points + "\n<knots>0</knots>"), 4, {"<knots> needs the attribute \"along\""}},
      {net_with(points + "\n<knots along=\"u\">0 0 0 1 1 1</knots>", "wrap=\"u\""),
       4,
       {"wrap closes along u"}},
      {net_with(points, "", "degreeU=\"3\" degreeV=\"1\""), 2, {"degreeU is 3", "columns - 1 = 2"}},
      {net_with(points, "", "degreeV=\"1\""), 2, {"<nurbs> needs the attribute \"degreeU\""}},
      {net_with(points, "unit=\"1\""), 2, {"<nurbs> has no attribute \"unit\""}},
      {net_with(points, "samplesU=\"2\" wrap=\"u\""), 2, {"samplesU is 2, but must be at least 3"}},
  });
}

TEST_CASE("what follows a driver has a shape and a transform only", "[scene][surface]") {
  const std::string grid = "<grid columns=\"3\" rows=\"3\"/>";
  const auto surfaces = [&](const std::string& driven) {
    return scene_with("<surface name=\"cage\">" + grid + "</surface>\n" + driven);
  };
  const auto skin = [&](const std::string& driver, const std::string& content = "") {
    return "<surface name=\"skin\" drivenBy=\"" + driver + "\">\n" + grid + content + "</surface>";
  };
  CHECK(scene_of(surfaces(skin("cage"))).surfaces.at(1).is_driven());
  check_each({
      {surfaces(skin("cafe")), 3, {"skin.drivenBy: no surface is named", "did you mean \"cage\"?"}},
      {surfaces(skin("skin")), 3, {"a surface cannot drive itself"}},
      {surfaces(skin("cage") + "\n<surface name=\"fur\" drivenBy=\"skin\">" + grid + "</surface>"),
       5,
       {"fur.drivenBy: \"skin\" is driven itself, by \"cage\""}},
      {surfaces(skin("cage", "\n<material density=\"1\"/>")), 5, {"has no <material>"}},
      {surfaces(skin("cage", "\n<solver/>")), 5, {"has no <solver>"}},
      {surfaces(skin("cage", "\n<tangents su0=\"1\"/>")), 5, {"has no <tangents>"}},
      {surfaces(skin("cage") + "\n<point name=\"p\" targets=\"cage skin\"/>"),
       5,
       {"p.targets: \"skin\" is driven by \"cage\""}},
      {surfaces(skin("cage") + "\n<group name=\"p\" targets=\"skin\"/>"),
       5,
       {"p.targets: \"skin\" is driven by \"cage\""}},
  });
}

}  // namespace
}  // namespace pliant::testing
