#pragma once

#include "pliant/region/selection.hpp"
#include "viewer/json.hpp"

namespace pliant::cli {

using viewer::Json;
using viewer::to_json;
using viewer::wrap_word;

inline Json to_json(const CutCounts& counts) {
  return {{"insideNodes", counts.inside_nodes},
          {"heldNodes", counts.held_nodes},
          {"cells", counts.cells}};
}

}  // namespace pliant::cli
