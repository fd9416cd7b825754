#include "pliant/scene/channels.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "pliant/scene/format/description.hpp"
#include "pliant/scene/format/resolve.hpp"
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
  for (const Collider& collider : scene.colliders) add(collider);
  return channels;
}

std::string no_channel(const Scene& scene, std::string_view path) {
  const auto at = xml::resolve(xml::scope_of(scene), path);
  if (!at) return at.error().message;
  const std::string progress = fmt::format("{}.progress", at->path.title());
  const auto is_it = [&](const NamedChannel& channel) { return channel.path == progress; };
  return fmt::format("{} is not a channel{}", in_quotes(path),
                     std::ranges::any_of(channels_of(scene), is_it)
                         ? "; the position follows a path, and its channel is " + progress
                         : "");
}

}  // namespace pliant
