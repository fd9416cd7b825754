#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace pliant::xml {

/// Where a text breaks the rules of UTF-8 or XML, and how.
struct EncodingFault {
  std::size_t at = 0;   ///< byte offset
  std::string message;  ///< one line
};

/// The first byte that is not valid UTF-8, or the first control character that XML does not allow.
/// NUL matters most: C strings, and so tinyxml2, end there.
std::optional<EncodingFault> find_encoding_fault(std::string_view text);

/// Whether XML allows this code point in a document.
bool is_xml_character(char32_t code_point);

}  // namespace pliant::xml
