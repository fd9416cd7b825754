#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "pliant/sampling/sampling.hpp"
#include "pliant/scene/channels.hpp"
#include "pliant/scene/format/format.hpp"
#include "pliant/scene/read.hpp"
#include "pliant/scene/write.hpp"
#include "pliant/states/state_key.hpp"
#include "support/catch.hpp"
#include "support/everything.hpp"

// Whatever channel the description of the format has is read, listed, written, sampled and hashed,
// without a line elsewhere.

namespace pliant::testing {
namespace {

/// A channel of an element, with two valid values.
struct Case {
  std::string element;
  std::string attribute;
  std::string first;
  std::string second;
};

std::vector<Case> cases() {
  std::vector<Case> cases;
  for (const ElementFormat& element : scene_format())
    for (const AttributeFormat& attribute : element.attributes) {
      if (!attribute.is_keyable) continue;
      Case one{std::string(element.name), std::string(attribute.name), "0.25", "0.5"};
      if (attribute.type == "vector") std::tie(one.first, one.second) = std::pair{"1 2 3", "2 3 5"};
      if (attribute.type == "boolean") std::tie(one.first, one.second) = std::pair{"true", "false"};
      cases.push_back(std::move(one));
    }
  return cases;
}

/// A scene in which the element has this attribute and these children.
std::string scene_around(const std::string& element, const std::string& attribute,
                         const std::string& children) {
  const bool is_hardening = (attribute + children).find("hardening") != std::string::npos;
  const std::string needs = is_hardening ? " yield=\"1\"" : "";
  const auto tag = [&](const std::string& own) {
    const bool is_it = element == own;
    return fmt::format("<{0}{1}{2}>{3}</{0}>", own, own == "path" ? " attribute=\"center\"" : "",
                       is_it ? attribute + needs : "",
                       (own == "path" ? "<waypoint at=\"0 0 0\"/><waypoint at=\"1 0 0\"/>"
                                        "<waypoint at=\"1 2 0\"/>"
                                      : "") +
                           (is_it ? children : ""));
  };
  const bool is_solid = element == "sphere" || element == "capsule" || element == "box";
  if (is_solid || element == "collider") {
    return fmt::format(
        "<scene start=\"1\" end=\"9\"><surface name=\"sheet\"><grid columns=\"5\" rows=\"5\"/>"
        "</surface><collider name=\"it\"{}>{}{}</collider></scene>",
        is_solid ? "" : attribute, is_solid ? "" : children, is_solid ? tag(element) : "<sphere/>");
  }
  const bool is_part = element == "transform" || element == "material" || element == "tangents" ||
                       element == "solver";
  const bool is_force = !is_part && element != "path" && element != "group";
  const std::string part = is_part ? tag(element) : "";
  const bool is_strength = (attribute + children).find("magnitude") != std::string::npos;
  const std::string strength = is_strength ? "" : " magnitude=\"1\"";
  const std::string force =
      is_force
          ? fmt::format("<{0} name=\"it\"{1}{2}>{3}</{0}>", element, strength, attribute, children)
          : fmt::format("<point name=\"{}\" magnitude=\"1\">{}</point>",
                        element == "path" ? "it" : "poke", element == "path" ? tag(element) : "");
  const std::string acting = element == "group" ? fmt::format("<group name=\"it\"{}>{}{}</group>",
                                                              attribute, children, force)
                                                : force;
  return fmt::format(
      "<scene start=\"1\" end=\"9\"><surface name=\"{}\"><grid columns=\"5\" "
      "rows=\"5\"/>{}</surface>{}</scene>",
      is_part ? "it" : "sheet", part, acting);
}

Scene scene_of(const std::string& text) {
  CAPTURE(text);
  auto scene = parse_scene(text, "scene.xml", "");
  REQUIRE(scene);
  return *std::move(scene);
}

/// The key of the state at frame 3, which all inputs of the step decide.
Hash key_of(const Scene& scene) {
  const SceneSampling sampling(scene);
  return next_key(Hash{}, sample_inputs(scene, sampling, 0, 3), 3).value();
}

/// The values of a channel at some frames.
std::vector<double> values_of(const NamedChannel& named) {
  std::vector<double> values;
  for (const double frame : {1.0, 2.5, 4.0, 9.0})
    for (const double number : value_at(named, frame)) values.push_back(number);
  return values;
}

const NamedChannel& find(const std::vector<NamedChannel>& channels, const std::string& path) {
  const auto found = std::find_if(channels.begin(), channels.end(),
                                  [&](const NamedChannel& named) { return named.path == path; });
  CAPTURE(path);
  REQUIRE(found != channels.end());
  return *found;
}

TEST_CASE("every channel of every kind is read, listed, written, sampled and hashed",
          "[simulation][channels]") {
  const std::vector<Case> all = cases();
  CHECK(all.size() > 50);
  for (const auto& [element, attribute, first, second] : all) {
    CAPTURE(element, attribute);
    const auto constant = [&, &element = element,
                           &attribute = attribute](const std::string& value) {
      return scene_of(scene_around(element, fmt::format(" {}=\"{}\"", attribute, value), ""));
    };
    const std::string keys = fmt::format(
        "<animate attribute=\"{}\"><key frame=\"1\" value=\"{}\"/><key frame=\"4\" value=\"{}\"/>"
        "</animate>",
        attribute, first, second);
    const Scene one = constant(first);
    const Scene other = constant(second);
    const Scene animated = scene_of(scene_around(element, "", keys));
    const std::string path =
        element == "path" ? "it.center.progress" : fmt::format("it.{}", attribute);

    const std::vector<NamedChannel> listed = channels_of(animated);
    CHECK(find(listed, path).is_animated());
    CHECK_FALSE(find(channels_of(one), path).is_animated());
    CHECK(values_of(find(channels_of(one), path)) != values_of(find(channels_of(other), path)));

    const auto text = to_xml(animated);
    REQUIRE(text);
    const Scene again = scene_of(*text);
    CHECK(one == constant(first));
    CHECK(again == animated);
    CHECK_FALSE(one == other);
    CHECK_FALSE(one == animated);
    const std::vector<NamedChannel> listed_again = channels_of(again);
    REQUIRE(listed_again.size() == listed.size());
    for (std::size_t k = 0; k < listed.size(); ++k) {
      CHECK(listed_again[k].path == listed[k].path);
      CHECK(values_of(listed_again[k]) == values_of(listed[k]));
    }

    CHECK(key_of(one) != key_of(other));
    CHECK(key_of(animated) == key_of(again));
  }
}

}  // namespace
}  // namespace pliant::testing
