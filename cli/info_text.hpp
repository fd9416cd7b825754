#pragma once

#include <string>

#include "scene_facts.hpp"

namespace pliant::cli {

/// The text that `pliant info` prints about a scene.
std::string info_text(const SceneFacts& facts);

}  // namespace pliant::cli
