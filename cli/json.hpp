#pragma once

#include "viewer/json.hpp"

namespace pliant::cli {

using viewer::Json;
using viewer::to_json;

}  // namespace pliant::cli
