#pragma once

#include "pliant/scene/element.hpp"
#include "pliant/scene/scene_file.hpp"

namespace pliant::xml {

/// Reads a <surface> with all its content.
Surface read_surface(const tinyxml2::XMLElement& element, SceneFile& file);

}  // namespace pliant::xml
