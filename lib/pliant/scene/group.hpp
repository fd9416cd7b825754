#pragma once

#include <vector>

#include "pliant/scene/element.hpp"
#include "pliant/scene/scene_file.hpp"

namespace pliant::xml {

/// Reads a <group>, and appends the forces in it to `forces`.
Group read_group(const tinyxml2::XMLElement& element, std::vector<Force>& forces, SceneFile& file);

}  // namespace pliant::xml
