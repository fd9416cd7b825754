#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/core/stop_request.hpp"

namespace pliant::xml {

/// An element that is written: its attributes with their values as they are read, then its text or
/// the elements in it.
struct ElementText {
  std::string name;
  std::vector<std::pair<std::string, std::string>> attributes = {};
  std::vector<ElementText> children = {};
  std::string text = {};
};

/// How elements are laid out.
struct Layout {
  std::string line_end = "\n";
  std::string indent = "  ";  ///< of an element in another
  char quote = '"';
  std::size_t columns = 100;  ///< a longer opening tag is broken between attributes
};

/// A value as an attribute in these quotes has it: what XML would read otherwise is a reference.
std::string encoded(std::string_view value, char quote = '"');

/// The value that XML reads from an attribute as it is written: references stand for characters, a
/// line end is a line feed. Requires: as `scan_markup` accepts it.
std::string decoded(std::string_view written);

/// `<name a="1" b="2"/>` of attributes as written, broken into lines if it is too long. `margin`:
/// the blanks before the element on its line. `closing`: `>` or `/>`.
std::string opening_tag(std::string_view name, std::span<const std::string> attributes,
                        std::string_view closing, std::string_view margin, const Layout& layout);

/// The element from < to >, without the blanks before it and the end of its line.
/// Not all of it if the caller wants it to stop.
std::string text_of(const ElementText& element, const Layout& layout = {},
                    const std::string& margin = {}, const StopRequest& should_stop = {});

}  // namespace pliant::xml
