#pragma once

#include <string_view>

#include "pliant/scene/findings.hpp"

namespace pliant::xml {

/// Checks that a text is well-formed XML with one root element, and of a size that can be read.
///
/// tinyxml2 reads the structure, but lets much through that XML does not: it passes unknown
/// entities on as text, stops at a NUL byte or a closing tag too many and ignores the rest, takes
/// invalid UTF-8 and character references to nothing, and compares each attribute of an element
/// with all others. Here such a file is a problem, told with its line. Returns whether there was
/// none.
bool check_markup(std::string_view text, Findings& findings);

}  // namespace pliant::xml
