#pragma once

#include "pliant/scene/element.hpp"
#include "pliant/scene/scene_file.hpp"

namespace pliant::xml {

/// Reads a force, whose kind is the one that `shape` holds.
Force read_force(const tinyxml2::XMLElement& element, decltype(Force::shape) shape,
                 SceneFile& file);

}  // namespace pliant::xml
