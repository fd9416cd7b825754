#include "pliant/scene/channels.hpp"

#include "pliant/scene/description.hpp"

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

}  // namespace pliant
