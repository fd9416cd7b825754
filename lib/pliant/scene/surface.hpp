#pragma once

#include "pliant/scene/element.hpp"
#include "pliant/scene/scene_file.hpp"

namespace pliant::xml {

/// Reads a <surface> with all its content. `fps` is null if it was not read without a problem; then
/// the number of steps per frame is not checked.
Surface read_surface(const tinyxml2::XMLElement& element, std::optional<double> fps,
                     SceneFile& file);

}  // namespace pliant::xml
