#include "viewer/force_values.hpp"

#include "pliant/scene/format/description.hpp"

namespace pliant::viewer {
namespace {

struct AddValues {
  const std::function<void(std::string_view, const ValueAt&)>& add;

  void operator()(const Attribute& attribute, const Channel<1>& channel) const {
    add(attribute.name, [&](int frame) { return Json(channel.at(frame)[0]); });
  }
  void operator()(const Attribute& attribute, const Channel<3>& channel) const {
    add(attribute.name, [&](int frame) { return Json(channel.at(frame)); });
  }
  void operator()(const Attribute& attribute, const PositionChannel& position) const {
    add(attribute.name, [&](int frame) { return Json(position.at(frame)); });
  }
  void operator()(const Attribute& attribute, const std::optional<Channel<3>>& channel) const {
    if (channel) (*this)(attribute, *channel);
  }
  template <class Other>
  void operator()(const Attribute&, const Other&) const {}  // not a channel
};

}  // namespace

void for_each_value(const Force& force,
                    const std::function<void(std::string_view, const ValueAt&)>& add) {
  std::visit([&](const auto& kind) { describe(AddValues{add}, kind); }, force.kind);
}

}  // namespace pliant::viewer
