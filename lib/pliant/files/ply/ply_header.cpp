#include "pliant/files/ply/ply_header.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <span>

#include <fmt/format.h>

#include "pliant/core/text.hpp"
#include "pliant/files/file_object.hpp"

namespace pliant::ply {
namespace {

std::optional<NumberType> to_type(std::string_view word) {
  constexpr std::array<std::array<std::string_view, 2>, 8> words = {{{"char", "int8"},
                                                                     {"uchar", "uint8"},
                                                                     {"short", "int16"},
                                                                     {"ushort", "uint16"},
                                                                     {"int", "int32"},
                                                                     {"uint", "uint32"},
                                                                     {"float", "float32"},
                                                                     {"double", "float64"}}};
  for (std::size_t k = 0; k < words.size(); ++k)
    if (word == words[k][0] || word == words[k][1]) return static_cast<NumberType>(k);
  return std::nullopt;
}

// `property TYPE NAME` or `property list COUNT_TYPE TYPE NAME`.
std::optional<Property> to_property(std::span<const std::string_view> words) {
  if (words.size() == 3) {
    const auto type = to_type(words[1]);
    return type ? std::optional(Property{std::string(words[2]), *type}) : std::nullopt;
  }
  if (words.size() != 5 || words[1] != "list") return std::nullopt;
  const auto count_type = to_type(words[2]);
  const auto type = to_type(words[3]);
  const bool is_whole = count_type && *count_type < NumberType::Float32;
  return is_whole && type ? std::optional(Property{std::string(words[4]), *type, count_type})
                          : std::nullopt;
}

Result<Encoding> to_encoding(std::span<const std::string_view> words, int line) {
  if (words.size() == 3 && words[2] == "1.0") {
    if (words[1] == "ascii") return Encoding::Ascii;
    if (words[1] == "binary_little_endian") return Encoding::LittleEndian;
    if (words[1] == "binary_big_endian") return Encoding::BigEndian;
  }
  return invalid(
      "the format must be ascii, binary_little_endian or binary_big_endian, each of version 1.0",
      line);
}

// The names of elements, and of the properties of the last one.
struct KnownNames {
  std::set<std::string_view> elements, properties;
};

// Adds the content of one header line.
Result<void> read_header_line(std::span<const std::string_view> words, int line, Header& header,
                              KnownNames& known) {
  const std::string_view keyword = words[0];
  if (keyword == "comment" || keyword == "obj_info") return {};
  if (keyword == "format") {
    const auto encoding = to_encoding(words, line);
    if (!encoding) return fail(encoding.error());
    header.encoding = *encoding;
    return {};
  }
  if (keyword == "element" && words.size() == 3) {
    const auto count = to_integer(words[2]);
    if (!count || *count < 0) {
      return invalid(fmt::format("the number of elements {} is not a whole number from 0 to {}",
                                 in_quotes(words[2]), std::numeric_limits<int>::max()),
                     line);
    }
    if (!known.elements.insert(words[1]).second)
      return invalid(fmt::format("the element {} is given twice", in_quotes(words[1])), line);
    header.elements.push_back({std::string(words[1]), *count, {}});
    known.properties.clear();
    return {};
  }
  if (keyword == "property" && !header.elements.empty()) {
    const auto property = to_property(words);
    if (!property) {
      return invalid(
          "a property must have the form `property TYPE NAME` or `property list TYPE TYPE NAME`",
          line);
    }
    if (!known.properties.insert(words.back()).second)
      return invalid(fmt::format("the property {} is given twice", in_quotes(property->name)),
                     line);
    header.elements.back().properties.push_back(*property);
    return {};
  }
  return invalid(
      fmt::format("the header has a line that begins with {}, which is not part of a PLY header",
                  in_quotes(std::string(keyword))),
      line);
}

}  // namespace

int PlyElement::find(std::initializer_list<std::string_view> names) const {
  for (const std::string_view each : names)
    for (std::size_t k = 0; k < properties.size(); ++k)
      if (properties[k].name == each) return static_cast<int>(k);
  return -1;
}

std::size_t size_of(NumberType type) {
  constexpr std::array<std::size_t, 8> sizes = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

Result<Header> read_header(std::string_view bytes, const StopRequest& should_stop) {
  Header header;
  KnownNames known;
  StopPoll poll(should_stop);
  constexpr std::size_t most_words = 6;  // one more than a line of a header may have
  constexpr std::size_t parts_of_line = 100;
  bool has_format = false;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
    std::string_view rest = bytes.substr(at, end - at);
    const int line = ++header.line_count;
    if (poll.after(parts_of_line + rest.size())) return interrupted();
    at = std::min(end + 1, bytes.size());
    if (line == 1) {
      if (trim(rest, ascii_blanks) != "ply") break;
      continue;
    }
    std::vector<std::string_view> words;
    for (auto word = next_word(rest, ascii_blanks); !word.empty() && words.size() < most_words;
         word = next_word(rest, ascii_blanks)) {
      words.push_back(word);
      if (words[0] == "comment" || words[0] == "obj_info") break;
    }
    if (words.empty()) continue;
    if (words[0] == "end_header") {
      if (!has_format) return invalid("the header names no format", line);
      header.size = at;
      return header;
    }
    has_format = has_format || words[0] == "format";
    if (auto read = read_header_line(words, line, header, known); !read) return fail(read.error());
  }
  return invalid(header.line_count < 2 ? "the file is not PLY: its first line is not `ply`"
                                       : "the file is truncated: it ends within its header");
}

}  // namespace pliant::ply
