#pragma once

#include <string>

#include "pliant/scene/format/attribute.hpp"
#include "pliant/scene/text/tree.hpp"

namespace pliant {
namespace xml {

/// The attributes of an <include>.
struct IncludeText {
  std::string file = {};
};

/// The attributes of a <define>.
struct DefineText {
  std::string name = {};
  std::string value = {};
};

}  // namespace xml

template <>
struct Description<xml::IncludeText> {
  static constexpr std::string_view element = xml::include_name;
  static constexpr std::string_view meaning =
      "A file whose content takes the place of this element.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "file",
                  .meaning = "the file whose content takes the place of the element",
                  .need = Need::Required,
                  .syntax = Syntax::Path},
        of.file...);
  }
};

template <>
struct Description<xml::DefineText> {
  static constexpr std::string_view element = xml::define_name;
  static constexpr std::string_view meaning =
      "A name for a text, which $name stands for from here on.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "name",
                  .meaning = "the name: a letter or _, then letters, digits and _",
                  .need = Need::Required},
        of.name...);
    row(Attribute{.name = "value",
                  .meaning = "what `$name` stands for from here on",
                  .need = Need::Required},
        of.value...);
  }
};

}  // namespace pliant
