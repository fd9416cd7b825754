#pragma once

#include <string>

#include "scene_facts.hpp"

namespace pliant::cli {

/// What `pliant info` tells of a scene, to read.
std::string info_text(const SceneFacts& facts);

}  // namespace pliant::cli
