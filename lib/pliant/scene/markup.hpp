#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "pliant/scene/findings.hpp"

namespace pliant::xml {

/// With which some programs begin a file in UTF-8.
inline constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

/// The bytes of a text from `begin` up to, but not including, `end`.
struct TextRange {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;

  std::string_view of(std::string_view text) const { return text.substr(begin, end - begin); }
};

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
};

/// The places of all elements and attributes of a text, in document order: an element is before
/// those in it, and the attributes of an element are before those of the next.
struct Markup {
  std::vector<ElementPlace> elements;  ///< the root first
  std::vector<AttributePlace> attributes;

  std::span<const AttributePlace> attributes_of(std::size_t element) const;
};

/// The most elements and attributes of a scene file. tinyxml2 needs about a hundred bytes for each.
inline constexpr std::size_t most_markup = 20'000'000;

/// Scans a text: well-formed XML with one root element, and of a size that can be read, so with at
/// most `most` elements and attributes. It may begin with a byte order mark. Requires: fewer than
/// 4 GiB.
///
/// tinyxml2 reads the structure, but accepts much that XML does not allow: it treats unknown
/// entities as text, stops at a NUL byte or a surplus closing tag and ignores the rest, and accepts
/// invalid UTF-8 and references to invalid characters. It also compares each attribute of an
/// element with all others, so an element with very many is slow. Here each of these is a problem,
/// reported with its line. Null if there was one; otherwise the places are those of the elements
/// and attributes in tinyxml2's tree.
///
/// `roots`: the elements that the root may be, of a file that a scene includes; empty: it is a
/// scene. The messages quote nothing of a file with another root.
std::optional<Markup> scan_markup(std::string_view text, Findings& findings,
                                  std::size_t most = most_markup,
                                  std::span<const std::string_view> roots = {});

/// Lines and columns of offsets in a text, counted from 1. It counts lines from the offset before,
/// so that all offsets in their order need one pass.
class LineCounter {
 public:
  explicit LineCounter(std::string_view text) : text_(text) {}

  int line_of(std::size_t offset);
  int column_of(std::size_t offset) const;  ///< in bytes, after the byte order mark

 private:
  std::string_view text_;
  std::size_t counted_ = 0;  // offset up to which line_ is counted
  int line_ = 1;
};

}  // namespace pliant::xml
