#include "pliant/scene/changed_text.hpp"

#include <string>
#include <vector>

#include "pliant/scene/read.hpp"
#include "support/catch.hpp"

using namespace pliant;

namespace {

constexpr const char* file = "a.xml";

Scene read(const std::string& text) { return parse_scene(text, file, "").value(); }

std::string changed(const std::string& text, const Scene& scene,
                    const std::vector<std::string>& paths) {
  return changed_text(text, scene, paths, file, "").value();
}

// A text with its one `old` replaced.
std::string with(std::string text, const std::string& old, const std::string& now) {
  const std::size_t at = text.find(old);
  REQUIRE(at != std::string::npos);
  REQUIRE(text.find(old, at + 1) == std::string::npos);
  return text.replace(at, old.size(), now);
}

const std::string scene_text =
    "\xEF\xBB\xBF<?xml version='1.0'?>\r\n<!-- magnitude=\"3\" <point name=\"f\"/> -->\r\n"
    "<scene start='1' end=\"9\">\r\n"
    "  <surface name='s'>\r\n"
    "    <grid columns=\"5\" rows=\"5\"/>\r\n"
    "    <material damping = ' 20 '\r\n"
    "              b=\"2\"/>\r\n"
    "    <animate attribute=\"density\"><key frame='1' value='10'/><key frame='9' value='2e1'/>"
    "</animate>\r\n"
    "  </surface>\r\n"
    "  <group name=\"g\"><point name=\"f\"/></group>\r\n"
    "  <surface name=\"t\"><grid columns=\"5\" rows=\"5\"/></surface>\r\n"
    "</scene>\r\n<!-- end -->";

Channel<1> keyed(std::vector<double> values) {
  CurveKeys<1> keys;
  for (const double value : values) {
    Key<1> key;
    key.frame = 1.0 + 8.0 * static_cast<double>(keys.keys.size());
    key.value = {value};
    keys.keys.push_back(key);
  }
  return Curve<1>::make(std::move(keys)).value();
}

}  // namespace

TEST_CASE("a channel is changed where it stands, and all other bytes stay", "[scene][changed]") {
  Scene scene = read(scene_text);
  scene.surfaces[0].material.damping = 0.125;
  CHECK(changed(scene_text, scene, {"s.damping"}) == with(scene_text, "' 20 '", "' 0.125 '"));
  scene.surfaces[0].material.density = keyed({5, 10});
  CHECK(changed(scene_text, scene, {"s.density"}) ==
        with(with(scene_text, "value='10'", "value='5'"), "value='2e1'", "value='10'"));
  scene.forces[0].magnitude = -12.5;
  CHECK(changed(scene_text, scene, {"f.magnitude"}) ==
        with(scene_text, "<group name=\"g\"><point name=\"f\"/>",
             "<group name=\"g\"><point name=\"f\" magnitude=\"-12.5\"/>"));
  // A new attribute is laid out as the last one.
  const std::string constant = with(scene_text,
                                    "    <animate attribute=\"density\"><key frame='1' value='10'/>"
                                    "<key frame='9' value='2e1'/></animate>\r\n",
                                    "");
  scene = read(constant);
  scene.surfaces[0].material.density = 3.0;
  CHECK(changed(constant, scene, {"s.density"}) ==
        with(constant, "b=\"2\"/>", "b=\"2\"\r\n              density=\"3\"/>"));
  // A material that is missing is added, once.
  scene.surfaces[1].material.density = 4.0;
  scene.surfaces[1].material.damping = 7.0;
  CHECK(changed(scene_text, scene, {"t.damping", "t.density"}) ==
        with(scene_text, "<surface name=\"t\"><grid columns=\"5\" rows=\"5\"/>",
             "<surface name=\"t\"><grid columns=\"5\" rows=\"5\"/><material damping=\"7\" "
             "density=\"4\"/>"));
}

TEST_CASE("what has its value already keeps its bytes", "[scene][changed]") {
  const Scene scene = read(scene_text);
  CHECK(changed(scene_text, scene, {"s.damping", "s.density"}) == scene_text);
  CHECK(changed(scene_text, scene, {}) == scene_text);
}

TEST_CASE("every number of a curve is changed", "[scene][changed]") {
  const std::string text =
      "<scene start=\"1\" end=\"9\"><surface name=\"s\"><grid columns=\"5\" rows=\"5\"/></surface>"
      "<point name=\"f\"><animate attribute=\"magnitude\" tangent=\"3\" before=\"slope 2\" "
      "after=\" slope  -4 \"><key frame=\"1\" value=\"10\" out=\"5\"/><key frame=\"3\" "
      "value=\"20\" left=\"15\" in=\"6\" outHandle=\"0.5 7\"/><key frame=\"5\" value=\"30\" "
      "tangent=\"8\"/><key frame=\"7\" value=\"40\" interpolation=\"elasticIn\" amplitude=\"50\" "
      "period=\"1\"/><key frame=\"8\" value=\"60\"/><key frame=\"20\" value=\"0\" "
      "tangent=\"flat\"/>"
      "<loop from=\"3\" to=\"8\" after=\"1\" offset=\"9\"/></animate></point></scene>";
  Scene scene = read(text);
  CurveKeys<1> keys = scene.forces[0].magnitude.curve().keys();
  const auto triple = [](Value<1>& value) { value[0] *= 3; };
  for (Key<1>& key : keys.keys) {
    triple(key.value);
    if (key.left) triple(*key.left);
    if (key.next.amplitude) *key.next.amplitude *= 3;
    for (Tangent<1>* const tangent : {&key.in, &key.out}) {
      triple(tangent->slope);
      triple(tangent->handle_value);
    }
  }
  triple(keys.before.slope);
  triple(keys.after.slope);
  triple(keys.loop->offset);
  scene.forces[0].magnitude = Channel<1>(Curve<1>::make(keys).value());
  const std::string result = changed(text, scene, {"f.magnitude"});
  CHECK(read(result).forces[0].magnitude.curve().keys() == keys);
  std::string wanted = text;
  for (const auto& [old, now] :
       std::vector<std::pair<std::string, std::string>>{{"tangent=\"3\"", "tangent=\"9\""},
                                                        {"\"slope 2\"", "\"slope 6\""},
                                                        {"\" slope  -4 \"", "\" slope  -12 \""},
                                                        {"value=\"10\"", "value=\"30!\""},
                                                        {"out=\"5\"", "out=\"15\""},
                                                        {"value=\"20\"", "value=\"60!\""},
                                                        {"left=\"15\"", "left=\"45\""},
                                                        {"in=\"6\"", "in=\"18\""},
                                                        {"0.5 7", "0.5 21"},
                                                        {"value=\"30\"", "value=\"90!\""},
                                                        {"tangent=\"8\"", "tangent=\"24\""},
                                                        {"value=\"40\"", "value=\"120!\""},
                                                        {"amplitude=\"50\"", "amplitude=\"150\""},
                                                        {"value=\"60\"", "value=\"180!\""},
                                                        {"offset=\"9\"", "offset=\"27\""}}) {
    wanted = with(wanted, old, now);
  }
  std::erase(wanted, '!');
  CHECK(result == wanted);
}

TEST_CASE("what the file cannot say is refused", "[scene][changed]") {
  const Scene scene = read(scene_text);
  const auto refusal = [&](const Scene& other, const std::string& path) {
    const auto result = changed_text(scene_text, other, std::vector{path}, file, "");
    REQUIRE_FALSE(result);
    CHECK(result.error().file == file);
    return result.error().message;
  };
  CHECK(refusal(scene, "h.magnitude").find("h.magnitude cannot be changed") == 0);
  Scene other = scene;
  other.surfaces[0].material.density = keyed({1, 2, 3});
  CHECK(refusal(other, "s.density").find("s.density") == 0);
  other.surfaces[0].material.density = 1.0;  // animated in the text
  CHECK_FALSE(refusal(other, "s.density").empty());
  other.surfaces[0].material.damping = keyed({1, 2});  // a constant there
  CHECK(refusal(other, "s.damping").find("s.damping") == 0);
  CHECK_FALSE(changed_text("<scene", scene, std::vector<std::string>{"s.damping"}, file, ""));
}
