#pragma once

#include <optional>
#include <string>

#include "pliant/scene/element.hpp"
#include "pliant/timeline/curve.hpp"

namespace pliant::xml {

/// Reads a <falloff> of the force `owner`: keys over s = distance / force radius, `at` from 0 to 1,
/// with the end values outside them. Null if there was a problem.
std::optional<Curve<1>> read_falloff(const tinyxml2::XMLElement& falloff, const std::string& owner,
                                     Findings& findings);

/// Checks that a force has only one falloff: its attribute or a single <falloff>. `first_line` is
/// the line of an earlier <falloff>; 0: this is the first.
void check_single_falloff(const tinyxml2::XMLElement& falloff, const Slot& attribute,
                          int& first_line, Findings& findings);

}  // namespace pliant::xml
