#pragma once

#include "pliant/scene/element.hpp"
#include "pliant/scene/scene_file.hpp"

namespace pliant::xml {

/// Reads a <surface> with all that stands in it. `fps` is known if it was read without a mistake;
/// without it, the number of steps in a frame is not checked.
Surface read_surface(const tinyxml2::XMLElement& element, std::optional<double> fps,
                     SceneFile& file);

}  // namespace pliant::xml
