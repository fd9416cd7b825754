#include "pliant/scene/channels.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pliant/scene/format/artist_words.hpp"
#include "pliant/scene/format/description.hpp"
#include "pliant/scene/format/nearest.hpp"
#include "pliant/scene/text/text.hpp"

namespace pliant {

bool NamedChannel::is_animated() const {
  return std::visit([](const auto* of) { return of->is_animated(); }, channel);
}

std::vector<NamedChannel> channels_of(const Scene& scene) {
  std::vector<NamedChannel> channels;
  const auto add = [&](const auto& thing) {
    for_each_channel(thing, [&](const std::string& name, const Attribute&, const auto& channel) {
      channels.push_back({thing.name + '.' + name, &channel});
    });
  };
  for (const Surface& surface : scene.surfaces) add(surface);
  for (const Force& force : scene.forces) add(force);
  for (const Group& group : scene.groups) add(group);
  return channels;
}

std::string channel_hint(const Scene& scene, std::string_view path) {
  const std::vector<NamedChannel> channels = channels_of(scene);
  const std::string_view name = path.substr(0, path.find('.'));
  std::vector<std::string_view> names, paths, attributes;
  for (const NamedChannel& channel : channels) {
    const std::size_t dot = channel.path.find('.');
    const std::string_view known = channel.path, owner = known.substr(0, dot);
    if (names.empty() || names.back() != owner) names.push_back(owner);
    if (owner != name) continue;
    paths.push_back(known);
    attributes.push_back(known.substr(dot + 1));
  }
  if (paths.empty())
    return fmt::format("; nothing is named {}{}", xml::in_quotes(name), xml::hint(name, names));
  std::vector<std::string_view> own;
  const std::string_view attribute = path.substr(std::min(name.size() + 1, path.size()));
  xml::attribute_hint(scene, name, attribute, attributes, own);
  std::vector<std::string> meant;
  for (const std::string_view one : own) meant.push_back(fmt::format("\"{}.{}\"", name, one));
  return fmt::format("; {}it has {}",
                     meant.empty() ? "" : "did you mean " + xml::joined_words(meant) + "? ",
                     fmt::join(paths, ", "));
}

}  // namespace pliant
