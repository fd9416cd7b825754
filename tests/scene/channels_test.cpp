#include "pliant/scene/channels.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "pliant/scene/format/format.hpp"
#include "scene/scene_text.hpp"
#include "support/scenes.hpp"

namespace pliant::testing {
namespace {

TEST_CASE("every attribute that takes keys is a channel", "[scene][channels]") {
  const Scene scene = scene_of(
      scene_with("<surface name=\"s\"><grid columns=\"3\" rows=\"3\"/></surface>\n"
                 "<point name=\"point\"/><radial name=\"radial\"/>"
                 "<line name=\"line\" direction=\"0 1 0\"/><uniform name=\"uniform\"/>"
                 "<vortex name=\"vortex\"/><noise name=\"noise\"/><inertia name=\"inertia\"/>"
                 "<pressure name=\"pressure\"/>"
                 "<group name=\"group\"/>"
                 "<collider name=\"sphere\"><sphere/></collider>"
                 "<collider name=\"capsule\"><capsule/></collider>"
                 "<collider name=\"box\"><box/></collider>"));
  std::set<std::string> paths;
  for (const NamedChannel& channel : channels_of(scene)) {
    // What every collider has counts once.
    const std::string attribute = channel.path.substr(channel.path.find('.') + 1);
    const bool is_of_shape = attribute == "radius" || attribute == "length" ||
                             attribute == "size" || attribute == "round";
    const bool is_solid = channel.path.starts_with("sphere.") ||
                          channel.path.starts_with("capsule.") || channel.path.starts_with("box.");
    if (is_solid && !is_of_shape) {
      paths.insert(attribute == "translate" || attribute == "rotate" || attribute == "scale"
                       ? "s." + attribute
                       : "collider." + attribute);
      continue;
    }
    CHECK(paths.insert(channel.path).second);
    CHECK_FALSE(channel.is_animated());
  }
  // A damping ratio takes the place of the damping, and a yield is there only if it is given.
  const Scene by_ratio =
      scene_of(scene_with("<surface name=\"s\"><grid columns=\"3\" rows=\"3\"/><material "
                          "dampingRatio=\"0.1\" yield=\"2\"/></surface>"));
  CHECK_FALSE(paths.contains("s.dampingRatio"));
  for (const NamedChannel& channel : channels_of(by_ratio)) {
    CHECK(channel.path != "s.damping");
    paths.insert(channel.path);
  }
  std::set<std::string> expected;
  for (const ElementFormat& element : scene_format()) {
    if (element.name == "path") continue;  // has its own channel, see below
    const auto& parents = element.parents;
    const bool is_child = std::find(parents.begin(), parents.end(), "scene") != parents.end();
    const bool is_solid = std::find(parents.begin(), parents.end(), "collider") != parents.end();
    const bool is_of_it = element.name != "transform" && is_solid;
    const std::string owner((is_child && element.name != "surface") || is_of_it ? element.name
                                                                                : "s");
    for (const AttributeFormat& attribute : element.attributes) {
      if (attribute.is_keyable && attribute.need != Need::Later) {
        expected.insert(owner + "." + std::string(attribute.name));
      }
    }
  }
  CHECK(paths == expected);
}

TEST_CASE("a position on a path has its progress as a channel", "[scene][channels][path]") {
  const std::string path =
      "<path attribute=\"{}\"><waypoint at=\"0 0 0\"/><waypoint at=\"1 0 0\"/>"
      "<waypoint at=\"1 1 0\"/></path>";
  const Scene scene = scene_of(scene_with(fmt::format(
      "<line name=\"l\">{}</line><group name=\"g\">{}<point name=\"p\"/></group>",
      fmt::format(fmt::runtime(path), "to"), fmt::format(fmt::runtime(path), "center"))));
  std::vector<std::string> paths;
  for (const NamedChannel& channel : channels_of(scene)) paths.push_back(channel.path);
  // The force in the group has no deformationRadius.
  CHECK(paths == std::vector<std::string>{"l.enabled", "l.magnitude", "l.deformationRadius",
                                          "l.forceRadius", "l.from", "l.to.progress", "p.enabled",
                                          "p.magnitude", "p.forceRadius", "p.center", "p.direction",
                                          "g.enabled", "g.center.progress", "g.deformationRadius"});
}

TEST_CASE("what is no channel is told with those that may be meant", "[scene][channels]") {
  const Scene scene = testing::scene({testing::sheet("sheet")}, {testing::poke("poke", {0, 0, 0})});
  CHECK(no_channel(scene, "sheet.stiffness")
            .starts_with("\"sheet\" has no attribute \"stiffness\"; did you mean \"b\", \"c\" and "
                         "\"d\"? allowed: "));
  for (const std::string word : {"strength", "magnitud"})
    CHECK(no_channel(scene, "poke." + word)
              .starts_with("\"poke\" has no attribute \"" + word +
                           "\"; did you mean \"magnitude\"? allowed: "));
  CHECK(no_channel(scene, "pike.magnitude") ==
        "nothing is named \"pike\"; did you mean \"poke\"? allowed: scene, sheet, poke");
  for (const char* const word : {"", "sheet"})
    CHECK(no_channel(scene, word).find("is not a path") != std::string::npos);
  CHECK(no_channel(scene, "poke.falloff") == "\"poke.falloff\" is not a channel");
}

TEST_CASE("channels point at the scene's own values", "[scene][channels]") {
  const Scene scene = scene_of(animate_with("", "<key frame=\"3\" value=\"7\"/>\n"));
  int animated = 0;
  for (const NamedChannel& channel : channels_of(scene)) {
    if (!channel.is_animated()) continue;
    ++animated;
    CHECK(channel.path == "poke.magnitude");
    CHECK(std::get<const Channel<1>*>(channel.channel)->at(5)[0] == 7);
  }
  CHECK(animated == 1);
}

}  // namespace
}  // namespace pliant::testing
