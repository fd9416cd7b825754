#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/scene/text/findings.hpp"

namespace pliant::xml {

/// Where an attribute stands in a text.
struct AttributePlace {
  TextRange name;
  TextRange value;  ///< as written, within the quotes

  TextRange whole() const { return {name.begin, value.end + 1}; }  ///< `name="value"`
};

/// Where an element stands in a text.
struct ElementPlace {
  static constexpr std::uint32_t no_parent = UINT32_MAX;

  TextRange name;                     ///< in the opening tag
  std::uint32_t tag_end = 0;          ///< of the opening tag
  std::uint32_t end = 0;              ///< of the closing tag, or of the only one
  std::uint32_t parent = no_parent;   ///< index of the element that contains it
  std::uint32_t first_attribute = 0;  ///< index of its first attribute, if it has one

  TextRange opening_tag() const { return {name.begin - 1, tag_end}; }  ///< from < to >
  TextRange whole() const { return {name.begin - 1, end}; }
  bool closes_itself() const { return end == tag_end; }  ///< `<name/>`
  /// Between its tags.
  TextRange content_in(std::string_view text) const {
    if (closes_itself()) return {end, end};
    return {tag_end, static_cast<std::uint32_t>(text.rfind('<', end - 1))};
  }
};

/// The places of all elements and attributes of a text, in document order: an element is before
/// those in it, and the attributes of an element are before those of the next.
struct Markup {
  std::vector<ElementPlace> elements;  ///< the root first
  std::vector<AttributePlace> attributes;

  std::span<const AttributePlace> attributes_of(std::size_t element) const;
  /// The attribute of that name; null: the element does not have it.
  const AttributePlace* attribute_of(std::size_t element, std::string_view name,
                                     std::string_view text) const;
  /// The index of the first element behind the end of one.
  std::size_t after(std::size_t element) const;
};

/// Far above any real scene. Readers recurse once per level.
inline constexpr std::size_t deepest_element = 50;
std::string nested_too_deep(std::string_view element);

/// The most elements and attributes of a scene file.
inline constexpr std::size_t most_markup = 20'000'000;

/// Scans a text of the findings: well-formed XML with one root element, and of a size that can be
/// read, so with at most `most` elements and attributes. It may begin with a byte order mark. Null
/// if there was a problem, or if reading is to end. Requires: fewer than 4 GiB.
///
/// `roots`: the elements that the root may be, of a file that a scene includes; empty: it is a
/// scene. The messages quote nothing of a file with another root.
std::optional<Markup> scan_markup(Findings& findings, int text = 0, std::size_t most = most_markup,
                                  std::span<const std::string_view> roots = {});

/// The places of a text that is to be a scene file, whose `name` is that in messages. Errors:
/// InvalidInput: it is larger than a scene file may be, or `scan_markup` finds problems.
/// Interrupted.
Result<Markup> markup_of(std::string_view text, const std::string& name,
                         const StopRequest& should_stop = {});

// Searches of a text from a place on, which ask whether reading is to end.

/// Where `what` begins; npos: nowhere, or reading is to end.
std::size_t find_from(std::string_view text, std::string_view what, std::size_t at,
                      Findings& findings);

/// Where the first character is that is no blank, otherwise the end of the text. A place before it
/// if reading is to end.
std::size_t first_not_blank(std::string_view text, std::size_t at, Findings& findings);

}  // namespace pliant::xml
