#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "pliant/scene/markup.hpp"

namespace pliant::cli {

/// The text of a scene whose attributes can be changed: all else stays as it is.
class EditedText {
 public:
  /// Requires: well-formed XML.
  explicit EditedText(std::string text);

  const std::string& text() const { return text_; }

  /// The first element of that name from `from` on, in the order of the text.
  std::optional<std::size_t> find(std::string_view name, std::size_t from = 0) const;
  std::string_view name_of(std::size_t element) const;
  std::size_t element_count() const { return markup_.elements.size(); }
  bool is_inside(std::size_t element, std::size_t ancestor) const;

  /// The value as it is written; null: it is absent.
  std::optional<std::string> attribute(std::size_t element, std::string_view name) const;

  /// Changes an attribute, or adds it behind the others. Requires: a value without quotes, & and <.
  void set(std::size_t element, std::string_view name, std::string_view value);

  /// Replaces an element, and a comment directly before it. Requires: well-formed XML.
  void replace_with_comment(std::size_t element, std::string_view text);

 private:
  void replace(std::size_t begin, std::size_t end, std::string_view by);

  std::string text_;
  xml::Markup markup_;
};

}  // namespace pliant::cli
