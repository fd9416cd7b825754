#pragma once

#include <string>

#include "scene_facts.hpp"

namespace pliant::cli {

/// The same as JSON: docs/info.md. Text that is no UTF-8, as a file's name may be, has U+FFFD where
/// it is not.
std::string info_json(const SceneFacts& facts);

}  // namespace pliant::cli
