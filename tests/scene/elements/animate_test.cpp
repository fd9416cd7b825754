#include <string>

#include "pliant/scene/elements/read_elements.hpp"
#include "scene/scene_text.hpp"

namespace pliant::testing {
namespace {

const std::string one_key = "<key frame=\"1\" value=\"1\"/>";

TEST_CASE("an animate names one channel of its element, once", "[scene][animate]") {
  check_each({
      {force_with("<animate attribute=\"magnitud\">" + one_key + "</animate>"),
       3,
       {"<animate> attribute=\"magnitud\": <point> has no such channel; did you mean "
        "\"magnitude\"? allowed: enabled, magnitude, deformationRadius, forceRadius, center, "
        "direction"}},
      {force_with("<animate attribute=\"falloff\">" + one_key + "</animate>"),
       3,
       {"attribute=\"falloff\": cannot be animated; the channels of <point> are: enabled"}},
      {force_with("<animate attribute=\"name\">" + one_key + "</animate>"),
       3,
       {"cannot be animated"}},
      {force_with("<animate attribute=\"strength\">" + one_key + "</animate>"),
       3,
       {"<point> has no such channel; did you mean \"magnitude\"?"}},
      {surface_with("<animate attribute=\"stiffness\">" + one_key + "</animate>"),
       3,
       {"<surface> has no such channel; did you mean \"b\", \"c\" and \"d\"?"}},
      {force_with("<animate attribute=\"\">" + one_key + "</animate>"), 3, {"no such channel"}},
      {scene_with("<point name=\"p\" magnitude=\"3\">\n<animate attribute=\"magnitude\">" +
                  one_key + "</animate></point>"),
       3,
       {"attribute=\"magnitude\": is already given (line 2)"}},
      {force_with("<animate attribute=\"magnitude\">" + one_key +
                  "</animate>\n<animate "
                  "attribute=\"magnitude\">" +
                  one_key + "</animate>"),
       4,
       {"is already animated (line 3)"}},
  });
}

TEST_CASE("the keys of an unknown channel are read for their own mistakes", "[scene][animate]") {
  for (const std::string& keys : {std::string("<key frame=\"1\" value=\"1\"/>"),
                                  std::string("<key frame=\"1\" value=\"1 2 3\"/>"),
                                  std::string("<key frame=\"1\" value=\"true\"/>")}) {
    CAPTURE(keys);
    CHECK(
        problems_of(force_with("<animate attribute=\"velocity\">" + keys + "</animate>")).size() ==
        1);
  }
  CHECK(problems_of(
            force_with("<animate attribute=\"velocity\"><key frame=\"x\" value=\"1\"/></animate>"))
            .size() == 2);
}

TEST_CASE("a tangent's keys have one number or three", "[scene][animate]") {
  const auto tangent_of = [](const std::string& keys) {
    return scene_of(surface_with("<tangents><animate attribute=\"su0\">" + keys +
                                 "</animate></tangents>"))
        .surfaces.at(0)
        .tangents.su0;
  };
  const TangentChannel one =
      tangent_of("<key frame=\"1\" value=\"2\"/><key frame=\"2\" value=\"3\"/>");
  CHECK(std::get<Channel<1>>(one).curve().keys().keys.at(1).value == Value<1>{3});
  const TangentChannel three = tangent_of(
      "<key frame=\"1\" value=\"2\" out=\"0.5\"/><key frame=\"2\" value=\"1 2 3\" left=\"7\"/>");
  const auto& keys = std::get<Channel<3>>(three).curve().keys().keys;
  CHECK(keys.at(0).value == Value<3>{2, 2, 2});
  CHECK(keys.at(0).out.slope == Value<3>{0.5, 0.5, 0.5});
  CHECK(keys.at(1).value == Value<3>{1, 2, 3});
  CHECK(keys.at(1).left == Value<3>{7, 7, 7});
  CHECK_THAT(problems_of(surface_with("<tangents>\n<animate attribute=\"su0\">\n<key frame=\"1\" "
                                      "value=\"1 2\"/></animate></tangents>"))
                 .at(0),
             Catch::Matchers::StartsWith("5: <key> value=\"1 2\": three numbers are required"));
}

TEST_CASE("a boolean channel steps", "[scene][animate]") {
  const Scene scene =
      scene_of(force_with("<animate attribute=\"enabled\" after=\"repeat\"><key frame=\"1\" "
                          "value=\"true\"/><key frame=\"4\" "
                          "value=\"false\" interpolation=\"stepNext\" left=\"true\"/><key "
                          "frame=\"5\" value=\"true\"/></animate>"));
  const auto& keys = scene.forces.at(0).enabled.channel().curve().keys().keys;
  CHECK(keys.at(0).value == Value<1>{1});
  CHECK(keys.at(0).next.kind == Interpolation::Kind::Step);
  CHECK(keys.at(1).value == Value<1>{0});
  CHECK(keys.at(1).next.kind == Interpolation::Kind::StepNext);
  CHECK(keys.at(1).left == Value<1>{1});
  const auto with = [](const std::string& animate, const std::string& rest) {
    return force_with("<animate attribute=\"enabled\" " + animate +
                      ">\n<key frame=\"1\" value=\"true\" " + rest + "/></animate>");
  };
  check_each({
      {with("", "interpolation=\"linear\""), 4, {"<key> interpolation", "steps", "step, stepNext"}},
      {with("interpolation=\"bezier\"", ""), 3, {"<animate> interpolation", "step, stepNext"}},
      {with("", "tangent=\"flat\""), 4, {"<key> tangent", "so tangent is not allowed"}},
      {with("", "inLength=\"1\""), 4, {"<key> inLength", "so inLength is not allowed"}},
      {with("", "amplitude=\"1\""), 4, {"<key> amplitude", "so amplitude is not allowed"}},
      {with("tangent=\"flat\"", ""), 3, {"<animate> tangent", "so tangent is not allowed"}},
      {with("overshoot=\"limit\"", ""), 3, {"<animate> overshoot", "so overshoot is not allowed"}},
      {with("after=\"linear\"", ""), 3, {"hold, repeat and mirror"}},
      {with("before=\"slope 1\"", ""), 3, {"hold, repeat and mirror"}},
      {with("after=\"repeatOffset\"", ""), 3, {"hold, repeat and mirror"}},
      {force_with("<animate attribute=\"enabled\">\n<key frame=\"1\" value=\"1\"/></animate>"),
       4,
       {"value=\"1\": must be true or false"}},
      {force_with("<animate attribute=\"enabled\"><key frame=\"1\" value=\"true\"/>\n"
                  "<loop from=\"1\" to=\"2\" offset=\"true\"/></animate>"),
       4,
       {"<loop> offset", "boolean"}},
  });
}

}  // namespace
}  // namespace pliant::testing
