#pragma once

#include <string_view>

#include "pliant/scene/findings.hpp"

namespace pliant::xml {

/// Checks that a text is well-formed XML with one root element, and of a size that can be read.
///
/// tinyxml2 reads the structure, but accepts much that XML does not allow: it treats unknown
/// entities as text, stops at a NUL byte or a surplus closing tag and ignores the rest, and accepts
/// invalid UTF-8 and references to invalid characters. It also compares each attribute of an
/// element with all others, so an element with very many is slow. Here each of these is a problem,
/// reported with its line. Returns whether there was none.
bool check_markup(std::string_view text, Findings& findings);

}  // namespace pliant::xml
