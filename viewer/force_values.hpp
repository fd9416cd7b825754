#pragma once

#include <functional>
#include <string_view>

#include "pliant/scene/scene.hpp"
#include "viewer/json.hpp"

namespace pliant::viewer {

/// The value of a channel at a frame: a number, or [x, y, z].
using ValueAt = std::function<Json(int frame)>;

/// Calls `add` for each channel of a force's kind, such as `center`: the name of its attribute and
/// its values. A position on a path is a position.
void for_each_value(const Force& force,
                    const std::function<void(std::string_view, const ValueAt&)>& add);

}  // namespace pliant::viewer
