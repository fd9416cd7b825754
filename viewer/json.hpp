#pragma once

#include <nlohmann/json.hpp>

#include "pliant/core/field.hpp"
#include "pliant/core/grid.hpp"
#include "pliant/core/transform.hpp"
#include "pliant/scene/channel_values.hpp"

namespace pliant::viewer {

/// Keys keep the order of insertion.
using Json = nlohmann::ordered_json;

/// [x, y, z].
inline Json to_json(const Vector3d& vector) { return {vector[0], vector[1], vector[2]}; }

inline Json to_json(const ChannelValue& value) {
  return std::visit([](const auto& one) { return Json(one); }, value);
}

/// The three rows of [linear, translation].
inline Json to_json(const Transform& transform) {
  Json numbers = Json::array();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) numbers.push_back(transform.linear(row, column));
    numbers.push_back(transform.translation[row]);
  }
  return numbers;
}

/// `u`, `v` or `uv`: the directions in which a grid is closed. Requires: it is closed.
inline const char* wrap_word(const Grid& grid) {
  return !grid.is_closed_v ? "u" : !grid.is_closed_u ? "v" : "uv";
}

}  // namespace pliant::viewer
