#pragma once

#include <nlohmann/json.hpp>

#include "pliant/core/field.hpp"
#include "pliant/core/grid.hpp"

namespace pliant::viewer {

/// Keys keep the order of insertion.
using Json = nlohmann::ordered_json;

/// [x, y, z].
inline Json to_json(const Vector3d& vector) { return {vector[0], vector[1], vector[2]}; }

/// Columns and rows, both ends included; null: an empty box.
inline Json to_json(const Box& box) {
  if (box.is_empty()) return nullptr;
  return {{"columns", {box.i0, box.i1}}, {"rows", {box.j0, box.j1}}};
}

}  // namespace pliant::viewer
