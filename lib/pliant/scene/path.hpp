#pragma once

#include <span>
#include <string>

#include "pliant/scene/element.hpp"
#include "pliant/scene/scene_file.hpp"

namespace pliant::xml {

/// Reads a <path> into the position that its `attribute` names among `rows`, the rows of the
/// element that contains it. `owner` is the name of the force or group. Problems: no such position,
/// one that is already given, animated or on a path, all problems of its waypoints and its
/// progress.
void read_path(const tinyxml2::XMLElement& element, std::span<Attribute> rows,
               const std::string& owner, SceneFile& file);

}  // namespace pliant::xml
