#pragma once

#include <functional>
#include <string_view>
#include <variant>

#include "pliant/scene/scene.hpp"

namespace pliant {

/// The value of a channel at a frame: a number, [x, y, z], or whether it is on.
using ChannelValue = std::variant<double, Value<3>, bool>;

using ValueAt = std::function<ChannelValue(int frame)>;

/// Calls `add` for each channel of a force's kind, such as `center`: the name of its attribute and
/// its values. A position on a path is a position. What follows a surface is in its object space.
void for_each_value(const Force& force,
                    const std::function<void(std::string_view, const ValueAt&)>& add);

/// Likewise for the channels of a collider and of its shape, but for its transform.
void for_each_value(const Collider& collider,
                    const std::function<void(std::string_view, const ValueAt&)>& add);

}  // namespace pliant
