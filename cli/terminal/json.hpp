#pragma once

#include "pliant/simulation/report_json.hpp"
#include "viewer/json.hpp"

namespace pliant::cli {

using viewer::Json;
using viewer::to_json;
using viewer::wrap_word;

}  // namespace pliant::cli
