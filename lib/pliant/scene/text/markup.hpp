#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "pliant/scene/text/findings.hpp"

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
  /// The index of the first element behind the end of one.
  std::size_t after(std::size_t element) const;
};

/// The most elements and attributes of a scene file.
inline constexpr std::size_t most_markup = 20'000'000;

/// Scans a text: well-formed XML with one root element, and of a size that can be read, so with at
/// most `most` elements and attributes. It may begin with a byte order mark. Each problem has its
/// line. Null if there was one, or if reading is to end. Requires: fewer than 4 GiB.
///
/// `roots`: the elements that the root may be, of a file that a scene includes; empty: it is a
/// scene. The messages quote nothing of a file with another root.
std::optional<Markup> scan_markup(std::string_view text, Findings& findings,
                                  std::size_t most = most_markup,
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

/// Lines and columns of offsets in a text, counted from 1, in any order: the text is read once.
class LineCounter {
 public:
  explicit LineCounter(std::string_view text) : text_(text) {}

  int line_of(std::size_t offset);
  int column_of(std::size_t offset) const;  ///< in bytes, after the byte order mark

 private:
  static constexpr std::size_t block_size = 1024;  // bytes

  int count(std::size_t from, std::size_t to) const;

  std::string_view text_;
  std::vector<int> lines_ = {1};  // of the first byte of each block, up to the last that was needed
  std::size_t counted_ = 0;       // the last offset
  int line_ = 1;                  // its line
};

}  // namespace pliant::xml
