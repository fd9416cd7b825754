#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/scene/format/description.hpp"

namespace pliant {
namespace xml {
struct Contents;
}

/// The format of an attribute: a row of docs/scene-format.md.
struct AttributeFormat {
  std::string_view name;
  std::string type;       ///< "number", "vector", "word", …
  std::string unit = {};  ///< empty: none
  /// The default as a file would give it; in parentheses: what its absence means; empty: none.
  std::string standard = {};
  std::string text = {};     ///< the default as a file would give it; empty: none
  std::string range = {};    ///< empty: anything of the type
  std::string meaning = {};  ///< for people, in Markdown
  Need need = Need::Optional;
  bool is_keyable = false;
  bool is_position = false;                      ///< a <path> may move it
  bool names_surfaces = false;                   ///< one, or some
  Range limits = {};                             ///< of its numbers
  std::span<const std::string_view> words = {};  ///< of a word

  bool has_components() const { return type == "vector" || type == "number or vector"; }
};

/// Elements that may stand in another one, in any order.
struct ChildFormat {
  std::vector<std::string_view> names;  ///< of one kind, or of several in each other's place
  Child row = {};
  bool is_part = false;  ///< the thing around it has its attributes as its own

  /// Whether one of several kinds stands there, whose attributes the thing around it has.
  bool is_choice() const { return !row.noun.empty(); }
};

/// The format of an element.
struct ElementFormat {
  std::string_view name;
  std::string_view meaning = {};  ///< for people
  std::vector<std::string_view> parents =
      {};  ///< elements that may contain it; empty: it is the root
  std::vector<AttributeFormat> attributes = {};
  std::vector<ChildFormat> children = {};
  bool may_include = false;          ///< an <include> or a <define> may stand in it
  std::optional<Numbers> text = {};  ///< what it contains besides elements; null: nothing
};

/// The format of a root element and of all that may stand in it, made from the descriptions that
/// reading and writing use.
std::vector<ElementFormat> formats_of(const xml::Contents& root);

/// The format of scenes.
const std::vector<ElementFormat>& scene_format();

/// The format as an XML schema, see `scene_schema`.
std::string schema_of(const std::vector<ElementFormat>& formats);

/// The element of that name; null: there is none.
const ElementFormat* find_format(const std::vector<ElementFormat>& formats, std::string_view name);

/// The elements that an <include> or a <define> may stand in.
std::vector<std::string_view> including_elements();

}  // namespace pliant
