#include "pliant/scene/channel_values.hpp"

#include "pliant/scene/format/description.hpp"

namespace pliant {
namespace {

struct AddValues {
  const std::function<void(std::string_view, const ValueAt&)>& add;

  void operator()(const Attribute& attribute, const Channel<1>& channel) const {
    add(attribute.name, [&](int frame) { return channel.at(frame)[0]; });
  }
  void operator()(const Attribute& attribute, const Channel<3>& channel) const {
    add(attribute.name, [&](int frame) { return channel.at(frame); });
  }
  void operator()(const Attribute& attribute, const PositionChannel& position) const {
    add(attribute.name, [&](int frame) { return position.at(frame); });
  }
  void operator()(const Attribute& attribute, const std::optional<Channel<3>>& channel) const {
    if (channel) (*this)(attribute, *channel);
  }
  void operator()(const Attribute& attribute, const Switch& channel) const {
    add(attribute.name, [&](int frame) { return channel.at(frame); });
  }
  template <class Other>
  void operator()(const Attribute&, const Other&) const {}  // not a channel
};

}  // namespace

void for_each_value(const Force& force,
                    const std::function<void(std::string_view, const ValueAt&)>& add) {
  std::visit([&](const auto& kind) { describe(AddValues{add}, kind); }, force.kind);
}

void for_each_value(const Collider& collider,
                    const std::function<void(std::string_view, const ValueAt&)>& add) {
  describe(AddValues{add}, collider);
  std::visit([&](const auto& shape) { describe(AddValues{add}, shape); }, collider.shape);
}

}  // namespace pliant
