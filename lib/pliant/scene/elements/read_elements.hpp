#pragma once

#include <optional>
#include <span>
#include <string>

#include "pliant/scene/elements/element.hpp"
#include "pliant/scene/elements/scene_file.hpp"
#include "pliant/scene/format/contents.hpp"
#include "pliant/scene/format/key_text.hpp"
#include "pliant/scene/text/findings.hpp"
#include "pliant/timeline/curve.hpp"

namespace pliant::xml {

/// Reads an element with all that stands in it. `owner` is the path of the thing around it, `sheet`
/// or `sheet.map.b`, under which its places are recorded; empty: it has no name.
void read_contents(const Element& element, Contents& contents, const std::string& owner,
                   SceneFile& file);

/// Reads an <animate> into the channel that its `attribute` names among `rows`, the rows of the
/// element that contains it. `owner` is the name of the surface or force, for notes. Problems: no
/// such channel, a channel that is already given or animated, all problems of its keys.
void read_animate(const Element& animate, std::span<Slot* const> rows, const std::string& owner,
                  Findings& findings);

/// Reads a <path> into the position that its `attribute` names among `rows`, the rows of the
/// element that contains it. `owner` is the name of the force or group. Problems: no such position,
/// one that is already given, animated or on a path, all problems of its waypoints and its
/// progress.
void read_path(const Element& element, std::span<Slot> rows, const std::string& owner,
               SceneFile& file);

/// Reads the keys of an <animate> or a <falloff>, for an <animate> also the loop and the modes
/// before and after the keys, and makes the curve. `channel` is the path, such as `poke.magnitude`,
/// for messages. Null if there was a problem.
template <int D>
std::optional<Curve<D>> read_curve(const Element& animate, KeyAxis axis, ValueKind kind,
                                   const std::string& channel, Findings& findings);

}  // namespace pliant::xml
