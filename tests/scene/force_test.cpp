#include "pliant/scene/force.hpp"

#include <string>

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
  const auto& point = std::get<PointChannels>(scene.forces[0].shape);
  CHECK(point.center.at(1) == Value<3>{1, 2, 3});
  CHECK(point.direction.at(1) == Value<3>{0, 0, -2});
  CHECK(std::get<RadialChannels>(scene.forces[1].shape).center.at(1) == Value<3>{4, 5, 6});
  CHECK(scene.forces[1].falloff == Falloff::Gaussian);
  CHECK_FALSE(scene.forces[1].enabled.at(1));
  const auto& line = std::get<LineChannels>(scene.forces[2].shape);
  CHECK(line.from.at(1) == Value<3>{7, 8, 9});
  CHECK(line.to.at(1) == Value<3>{1, 0, 1});
  CHECK_FALSE(line.direction);
  REQUIRE(std::get<LineChannels>(scene.forces[3].shape).direction);
  CHECK(std::get<LineChannels>(scene.forces[3].shape).direction->at(1) == Value<3>{1, 0, 0});
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
  const auto& line = std::get<LineChannels>(force.shape);
  CHECK(line.from.is_animated());
  CHECK(line.to.is_animated());
  REQUIRE(line.direction);
  CHECK(line.direction->is_animated());
  CHECK(line.direction->curve().keys().keys.at(0).value == Value<3>{1, 2, 3});
}

}  // namespace
}  // namespace pliant::testing
