#include "pliant/scene/encoding.hpp"

#include <fmt/format.h>

namespace pliant::xml {
namespace {

unsigned byte_at(std::string_view text, std::size_t at) {
  return at < text.size() ? static_cast<unsigned char>(text[at]) : 0U;
}

/// The number of bytes of the character at `at`, 0 if it is not valid UTF-8. Source: The Unicode
/// Standard 15, table 3-7: the second byte's limits rule out overlong forms, surrogates and code
/// points past U+10FFFF.
std::size_t character_length(std::string_view text, std::size_t at) {
  const unsigned lead = byte_at(text, at);
  if (lead < 0x80) return 1;
  const std::size_t length = lead >= 0xC2 && lead <= 0xDF   ? 2
                             : lead >= 0xE0 && lead <= 0xEF ? 3
                             : lead >= 0xF0 && lead <= 0xF4 ? 4
                                                            : 0;
  const unsigned least = lead == 0xE0 ? 0xA0 : lead == 0xF0 ? 0x90 : 0x80;
  const unsigned most = lead == 0xED ? 0x9F : lead == 0xF4 ? 0x8F : 0xBF;
  for (std::size_t k = 1; k < length; ++k) {
    const unsigned byte = byte_at(text, at + k);
    if (byte < (k == 1 ? least : 0x80) || byte > (k == 1 ? most : 0xBF)) return 0;
  }
  return length;
}

}  // namespace

std::optional<EncodingFault> find_encoding_fault(std::string_view text) {
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
    return EncodingFault{0, "the file is UTF-16; save it as UTF-8"};
  for (std::size_t at = 0; at < text.size();) {
    const unsigned byte = byte_at(text, at);
    if (byte == 0)
      return EncodingFault{at, "the file contains a NUL byte; a scene must be text in UTF-8"};
    if (byte < 0x20 && byte != '\t' && byte != '\n' && byte != '\r')
      return EncodingFault{
          at,
          fmt::format("the file contains the control character 0x{:02X}, which XML does not allow",
                      byte)};
    const std::size_t length = character_length(text, at);
    if (length == 0)
      return EncodingFault{
          at, fmt::format("the byte 0x{:02X} is not UTF-8; save the file as UTF-8", byte)};
    at += length;
  }
  return std::nullopt;
}

bool is_xml_character(char32_t code_point) {
  return code_point == '\t' || code_point == '\n' || code_point == '\r' ||
         (code_point >= 0x20 && code_point <= 0xD7FF) ||
         (code_point >= 0xE000 && code_point <= 0xFFFD) ||
         (code_point >= 0x10000 && code_point <= 0x10FFFF);
}

}  // namespace pliant::xml
