#pragma once

#include <string>
#include <vector>

#include "pliant/scene/element.hpp"
#include "pliant/scene/scene_file.hpp"

namespace pliant::xml {

/// One force of each kind that has an element, with its defaults, in the order of the format.
std::vector<Force> force_kinds();

/// A force of the same kind, with the defaults of the kind.
Force standard_force(const Force& force);

/// Reads a force into `force`, which has the defaults of its kind. `group` is the group that
/// contains it, or null; a force in a group has no deformation radius of its own.
Force read_force(const tinyxml2::XMLElement& element, Force force, const Group* group,
                 SceneFile& file);

/// Reads a <group>, and appends the forces in it to `forces`.
Group read_group(const tinyxml2::XMLElement& element, std::vector<Force>& forces, SceneFile& file);

}  // namespace pliant::xml
