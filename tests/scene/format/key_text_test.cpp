#include "pliant/scene/format/key_text.hpp"

#include <string>
#include <vector>

#include "scene/scene_text.hpp"

namespace pliant::testing {
namespace {

using Kind = Interpolation::Kind;

/// The keys of poke's magnitude, as given.
CurveKeys<1> curve_of(const std::string& attributes, const std::string& keys) {
  return scene_of(animate_with(attributes, keys)).forces.at(0).magnitude.curve().keys();
}

/// One key at frame 1, another at frame 9, with these attributes at the first.
Key<1> read_key(const std::string& attributes, const std::string& animate = "") {
  return curve_of(animate, "<key frame=\"1\" value=\"5\" " + attributes +
                               "/><key frame=\"9\" value=\"7\" interpolation=\"linear\"/>")
      .keys.at(0);
}

TEST_CASE("every interpolation has its word", "[scene][key_text]") {
  const std::vector<std::pair<std::string, Kind>> kinds = {{"step", Kind::Step},
                                                           {"stepNext", Kind::StepNext},
                                                           {"linear", Kind::Linear},
                                                           {"bezier", Kind::Bezier}};
  for (const auto& [word, kind] : kinds) {
    CAPTURE(word);
    CHECK(read_key("interpolation=\"" + word + "\"").next == Interpolation{.kind = kind});
  }
  const std::vector<std::pair<std::string, Ease>> eases = {
      {"sine", Ease::Sine},      {"quad", Ease::Quad},   {"cubic", Ease::Cubic},
      {"quart", Ease::Quart},    {"quint", Ease::Quint}, {"expo", Ease::Expo},
      {"circ", Ease::Circ},      {"back", Ease::Back},   {"bounce", Ease::Bounce},
      {"elastic", Ease::Elastic}};
  const std::vector<std::pair<std::string, EaseSide>> sides = {
      {"In", EaseSide::In}, {"Out", EaseSide::Out}, {"InOut", EaseSide::InOut}};
  for (const auto& [ease_word, ease] : eases)
    for (const auto& [side_word, side] : sides) {
      CAPTURE(ease_word, side_word);
      CHECK(read_key("interpolation=\"" + ease_word + side_word + "\"").next ==
            Interpolation{.kind = Kind::Easing, .ease = ease, .side = side});
    }
  CHECK(read_key("interpolation=\"cubicBezier\" control=\"0.25 -1 1 2\"").next ==
        Interpolation{.kind = Kind::CubicBezier, .control = {0.25, -1, 1, 2}});
  CHECK(read_key("interpolation=\"elasticIn\" amplitude=\"2\" period=\"3\"").next ==
        Interpolation{.kind = Kind::Easing,
                      .ease = Ease::Elastic,
                      .side = EaseSide::In,
                      .amplitude = 2,
                      .period = 3});
  CHECK(read_key("back=\"0\"", "interpolation=\"backOut\"").next ==
        Interpolation{.kind = Kind::Easing, .ease = Ease::Back, .side = EaseSide::Out, .back = 0});
}

TEST_CASE("every tangent has its word, or is a slope", "[scene][key_text]") {
  using Side = Tangent<1>::Kind;
  const std::vector<std::pair<std::string, Side>> kinds = {
      {"auto", Side::Auto},     {"spline", Side::Spline},   {"linear", Side::Linear},
      {"flat", Side::Flat},     {"clamped", Side::Clamped}, {"plateau", Side::Plateau},
      {"smooth", Side::Smooth}, {"free", Side::Free}};
  for (const auto& [word, kind] : kinds) {
    CAPTURE(word);
    const Key<1> both = read_key("tangent=\"" + word + "\"");
    CHECK(both.in == Tangent<1>{.kind = kind});
    CHECK(both.out == Tangent<1>{.kind = kind});
    CHECK(read_key("", "tangent=\"" + word + "\"").out == Tangent<1>{.kind = kind});
  }
  const Key<1> sides = read_key("in=\"-1.5e1\" out=\"flat\" inLength=\"0\" outLength=\"2.5\"");
  CHECK(sides.in == Tangent<1>{.kind = Side::Slope, .slope = {-15}, .length = 0});
  CHECK(sides.out == Tangent<1>{.kind = Side::Flat, .length = 2.5});
  const Key<1> handles = read_key("inHandle=\"-2 3\" outHandle=\"0 4\"");
  CHECK(handles.in == Tangent<1>{.kind = Side::Handle, .handle_frames = -2, .handle_value = {3}});
  CHECK(handles.out == Tangent<1>{.kind = Side::Handle, .handle_value = {4}});
  // One side is given, the other keeps the default.
  const Key<1> mixed = read_key("out=\"2\"", "tangent=\"spline\"");
  CHECK(mixed.in.kind == Side::Spline);
  CHECK(mixed.out == Tangent<1>{.kind = Side::Slope, .slope = {2}});
}

TEST_CASE("every outside mode has its word", "[scene][key_text]") {
  using Outside = Extrapolation<1>::Kind;
  const std::vector<std::pair<std::string, Extrapolation<1>>> modes = {
      {"hold", {.kind = Outside::Hold}},
      {"linear", {.kind = Outside::Linear}},
      {"linearOuter", {.kind = Outside::LinearOuter}},
      {"slope -2.5", {.kind = Outside::Slope, .slope = {-2.5}}},
      {"repeat", {.kind = Outside::Repeat}},
      {"repeat 3", {.kind = Outside::Repeat, .count = 3}},
      {" repeatOffset\t1 ", {.kind = Outside::RepeatOffset, .count = 1}},
      {"mirror 1000000", {.kind = Outside::Mirror, .count = 1e6}},
  };
  for (const auto& [text, mode] : modes) {
    CAPTURE(text);
    const std::string keys = "<key frame=\"1\" value=\"5\"/><key frame=\"2\" value=\"6\"/>";
    CHECK(curve_of("before=\"" + text + "\"", keys).before == mode);
    CHECK(curve_of("after=\"" + text + "\"", keys).after == mode);
  }
}

TEST_CASE("a vector channel has three numbers wherever one has one", "[scene][key_text]") {
  const Scene scene =
      scene_of(force_with("<animate attribute=\"center\" before=\"slope 1 2 3\" tangent=\"4 5 "
                          "6\"><key frame=\"1\" value=\"1 2 3\" "
                          "outHandle=\"2 7 8 9\"/><key frame=\"2\" value=\"0 0 0\" left=\"1 1 "
                          "1\"/><loop from=\"1\" to=\"2\" "
                          "after=\"1\" offset=\"1 0 0\"/></animate>"));
  const CurveKeys<3>& curve =
      std::get<PointChannels>(scene.forces.at(0).kind).center.channel()->curve().keys();
  CHECK(curve.before.slope == Value<3>{1, 2, 3});
  CHECK(curve.keys.at(0).in.slope == Value<3>{4, 5, 6});
  CHECK(curve.keys.at(0).out.handle_frames == 2);
  CHECK(curve.keys.at(0).out.handle_value == Value<3>{7, 8, 9});
  CHECK(curve.keys.at(1).left == Value<3>{1, 1, 1});
  REQUIRE(curve.loop);
  CHECK(curve.loop->offset == Value<3>{1, 0, 0});
  const auto with = [](const std::string& animate, const std::string& key) {
    return force_with("<animate attribute=\"center\" " + animate +
                      ">\n<key frame=\"1\" value=\"1 2 3\" " + key + "/></animate>");
  };
  check_each({
      {with("", "in=\"1\""), 4, {"in=\"1\": as a slope: three numbers are required, not 1"}},
      {with("", "left=\"1\""), 4, {"left=\"1\": three numbers are required"}},
      {with("", "outHandle=\"1 2\""), 4, {"handle's value", "three numbers are required"}},
      {with("after=\"slope 1\"", ""), 3, {"the slope: three numbers are required"}},
      {force_with("<animate attribute=\"center\">\n<key frame=\"1\" value=\"1\"/></animate>"),
       4,
       {"value=\"1\": three numbers are required, not 1"}},
  });
}

TEST_CASE("each word of a key that cannot be read is told with its rule", "[scene][key_text]") {
  const auto key = [](const std::string& attributes) {
    return animate_with("", "<key frame=\"1\" value=\"5\" " + attributes + "/>");
  };
  const auto animate = [](const std::string& attributes) {
    return animate_with(attributes, "<key frame=\"1\" value=\"5\"/>");
  };
  check_each({
      {animate_with("", "<key frame=\"nan\" value=\"5\"/>"),
       4,
       {"frame=\"nan\": not a finite number"}},
      {animate_with("", "<key frame=\"1\" value=\"5,5\"/>"), 4, {"value=\"5,5\": not a number"}},
      {animate_with("", "<key frame=\"1\" value=\"1 2 3\"/>"),
       4,
       {"one number is required, not 3"}},
      {key("interpolation=\"bounceot\""),
       4,
       {"did you mean \"bounceOut\"?", "followed by In, Out or InOut"}},
      {key("interpolation=\"bounce\""), 4, {"unknown word", "followed by In, Out or InOut"}},
      {key("interpolation=\"hold\""), 4, {"unknown word", "step, stepNext, linear, bezier"}},
      {key("interpolation=\"\""), 4, {"unknown word"}},
      {key("tangent=\"flatt\""), 4, {"did you mean \"flat\"?", "or a slope"}},
      {key("in=\"1,5\""), 4, {"in=\"1,5\": as a slope: not a number"}},
      {key("out=\"1 2 3\""), 4, {"as a slope: one number is required"}},
      {key("in=\"-\""), 4, {"as a slope"}},
      {key("inLength=\"long\""), 4, {"inLength=\"long\": not a number"}},
      {key("inHandle=\"-1\""), 4, {"the handle's value, after its frames: is empty"}},
      {key("inHandle=\"x 1\""), 4, {"the handle's frames: not a number"}},
      {key("outHandle=\"\""), 4, {"the handle's frames: is empty"}},
      {key("left=\"\""), 4, {"left=\"\": is empty"}},
      {key("interpolation=\"cubicBezier\" control=\"0 0 1\""),
       4,
       {"four numbers are required, not 3"}},
      {key("interpolation=\"cubicBezier\" control=\"-0.1 0 1 1\""),
       4,
       {"x1 and x2 must be from 0 to 1"}},
      {key("interpolation=\"cubicBezier\" control=\"0 0 1.5 1\""),
       4,
       {"x1 and x2 must be from 0 to 1"}},
      {key("interpolation=\"elasticIn\" amplitude=\"-1\""), 4, {"must be at least 0"}},
      {key("interpolation=\"elasticIn\" period=\"-1\""), 4, {"must be at least 0"}},
      {animate("after=\"repeet\""),
       3,
       {"did you mean \"repeat\"?", "hold, linear, linearOuter, slope"}},
      {animate("after=\"repeat 0\""), 3, {"the count: must be at least 1"}},
      {animate("after=\"repeat 2.5\""), 3, {"the count: not a whole number"}},
      {animate("after=\"repeat 2 3\""), 3, {"the count: not a whole number"}},
      {animate("before=\"slope\""), 3, {"the slope: is empty"}},
      {animate("before=\"slope x\""), 3, {"the slope: not a number"}},
      {animate("before=\"hold 3\""), 3, {"\"3\" follows hold, which has no parameter"}},
      {animate("after=\"\""), 3, {"unknown word"}},
      {animate("overshoot=\"clip\""), 3, {"limit, keepStart, contain, error"}},
      {animate("tangent=\"steep\""), 3, {"unknown word", "or a slope"}},
      {animate("interpolation=\"ease\""), 3, {"unknown word"}},
      {animate("amplitude=\"3\""), 3, {"<animate> has no attribute \"amplitude\""}},
  });
}

}  // namespace
}  // namespace pliant::testing
