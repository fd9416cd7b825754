#pragma once

#include <optional>
#include <string>

#include "pliant/scene/findings.hpp"
#include "pliant/scene/key_text.hpp"
#include "pliant/timeline/curve.hpp"

namespace pliant::xml {

/// Reads the keys of an <animate> or a <falloff>, for an <animate> also the loop and the modes
/// before and after the keys, and makes the curve. `channel` is the path, such as `poke.magnitude`,
/// for messages. Null if there was a problem.
template <int D>
std::optional<Curve<D>> read_curve(const tinyxml2::XMLElement& animate, KeyAxis axis,
                                   ValueKind kind, const std::string& channel, Findings& findings);

}  // namespace pliant::xml
