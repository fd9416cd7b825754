#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pliant {

/// Whether an attribute or element is read.
enum class Need {
  Optional,
  Required,
  Later,  ///< known to the format, not supported by this version
};

/// What the format says of an attribute: a row of docs/scene-format.md.
struct AttributeFormat {
  std::string_view name;
  std::string_view type;  ///< "number", "vector", "word", …
  std::string unit = {};  ///< empty: none
  /// The default as it would be written; in parentheses: what absence means; empty: none.
  std::string standard = {};
  std::string range = {};  ///< empty: anything of the type
  Need need = Need::Optional;
  bool is_keyable = false;
};

/// What the format says of an element.
struct ElementFormat {
  std::string_view name;
  std::vector<std::string_view> parents;  ///< what it stands in; empty: the root
  Need need = Need::Optional;
  std::vector<AttributeFormat> attributes;
};

/// The whole format as the reader knows it, made from the tables that it reads with.
std::vector<ElementFormat> scene_format();

}  // namespace pliant
