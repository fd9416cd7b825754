#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace pliant::xml {

/// Where a text is not what XML allows in UTF-8, and why.
struct EncodingFault {
  std::size_t at = 0;   ///< byte offset
  std::string message;  ///< one line
};

/// The first byte that is no UTF-8, or a control character that XML does not allow (NUL above all:
/// C strings, and so tinyxml2, end there).
std::optional<EncodingFault> find_encoding_fault(std::string_view text);

/// Whether XML allows this code point in a document.
bool is_xml_character(char32_t code_point);

}  // namespace pliant::xml
