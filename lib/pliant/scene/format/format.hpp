#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/scene/format/description.hpp"

namespace pliant {

/// The format of an attribute: a row of docs/scene-format.md.
struct AttributeFormat {
  std::string_view name;
  std::string type;       ///< "number", "vector", "word", …
  std::string unit = {};  ///< empty: none
  /// The default as a file would give it; in parentheses: what its absence means; empty: none.
  std::string standard = {};
  std::string range = {};    ///< empty: anything of the type
  std::string meaning = {};  ///< for people, in Markdown
  Need need = Need::Optional;
  bool is_keyable = false;
  Range limits = {};                             ///< of its numbers
  std::span<const std::string_view> words = {};  ///< of a word
};

/// The format of an element.
struct ElementFormat {
  std::string_view name;
  std::vector<std::string_view> parents;  ///< elements that may contain it; empty: it is the root
  Need need = Need::Optional;
  std::vector<AttributeFormat> attributes;
  std::string_view text = {};  ///< what it contains besides elements, for people; empty: nothing
};

/// The whole format, made from the same tables that the reader uses.
std::vector<ElementFormat> scene_format();

}  // namespace pliant
