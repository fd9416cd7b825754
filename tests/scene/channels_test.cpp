#include "pliant/scene/channels.hpp"

#include <set>
#include <string>

#include "pliant/scene/format.hpp"
#include "scene/scene_text.hpp"

namespace pliant::testing {
namespace {

TEST_CASE("every attribute that takes keys is a channel", "[scene][channels]") {
  const Scene scene = scene_of(
      scene_with("<surface name=\"s\"><grid columns=\"3\" rows=\"3\"/></surface>\n"
                 "<point name=\"p\"/><radial name=\"r\"/><line name=\"l\" direction=\"0 1 0\"/>"));
  std::set<std::string> paths;
  for (const NamedChannel& channel : channels_of(scene)) {
    CHECK(paths.insert(channel.path).second);
    CHECK_FALSE(channel.is_animated());
  }
  std::set<std::string> expected;
  for (const ElementFormat& element : scene_format()) {
    std::string owner = element.name == "point"    ? "p"
                        : element.name == "radial" ? "r"
                        : element.name == "line"   ? "l"
                                                   : "s";
    for (const AttributeFormat& attribute : element.attributes) {
      if (attribute.is_keyable && attribute.need != Need::Later) {
        expected.insert(owner + "." + std::string(attribute.name));
      }
    }
  }
  CHECK(paths == expected);
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
