#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pliant/scene/reading/element.hpp"
#include "pliant/scene/reading/key_text.hpp"
#include "pliant/scene/reading/scene_file.hpp"
#include "pliant/scene/text/findings.hpp"
#include "pliant/timeline/curve.hpp"

namespace pliant::xml {

/// Reads a <surface> with all its content.
Surface read_surface(const Element& element, SceneFile& file);

/// One force of each kind that has an element, with its defaults, in the order of the format.
std::vector<Force> force_kinds();

/// A force of the same kind, with the defaults of the kind.
Force standard_force(const Force& force);

/// Reads a force into `force`, which has the defaults of its kind. `group` is the group that
/// contains it, or null; a force in a group has no deformation radius of its own.
Force read_force(const Element& element, Force force, const Group* group, SceneFile& file);

/// Reads a <group>, and appends the forces in it to `forces`.
Group read_group(const Element& element, std::vector<Force>& forces, SceneFile& file);

/// Reads an <animate> into the channel that its `attribute` names among `rows`, the rows of the
/// element that contains it. `owner` is the name of the surface or force, for notes. Problems: no
/// such channel, a channel that is already given or animated, all problems of its keys.
void read_animate(const Element& animate, std::span<Slot* const> rows, const std::string& owner,
                  Findings& findings);

/// The same for a single table.
void read_animate(const Element& animate, Table& table, const std::string& owner,
                  Findings& findings);

/// Reads the keys of an <animate> or a <falloff>, for an <animate> also the loop and the modes
/// before and after the keys, and makes the curve. `channel` is the path, such as `poke.magnitude`,
/// for messages. Null if there was a problem.
template <int D>
std::optional<Curve<D>> read_curve(const Element& animate, KeyAxis axis, ValueKind kind,
                                   const std::string& channel, Findings& findings);

}  // namespace pliant::xml
