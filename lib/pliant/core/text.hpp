#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pliant {

/// The number that the whole text spells in the C locale, decimal and finite; nullopt for `1,5`,
/// `0x10`, `nan`, `1e999`, `1e-999`, `1.5abc` and the empty text. A leading `+` is accepted.
/// Correctly rounded.
std::optional<double> to_number(std::string_view text);

/// The integer that the whole text spells; nullopt for other texts and outside the range of int.
std::optional<int> to_integer(std::string_view text);

/// The number rounded to significant decimal digits; itself if `digits` is 0 or it is not finite.
double with_digits(double number, int digits);

/// With which some programs begin a file in UTF-8.
inline constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

/// The characters that separate the words of a text file.
inline constexpr std::string_view ascii_blanks = " \t\r\n\v\f";

/// The text without the characters of `blanks` at both its ends.
inline std::string_view trim(std::string_view text, std::string_view blanks) {
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// Removes the first word, up to one of `blanks`, from the front of the text; empty: it has none.
inline std::string_view next_word(std::string_view& text, std::string_view blanks) {
  const std::size_t begin = std::min(text.find_first_not_of(blanks), text.size());
  const std::size_t end = std::min(text.find_first_of(blanks, begin), text.size());
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

/// All words of a text: parts of it.
std::vector<std::string_view> words_of(std::string_view text, std::string_view blanks);

/// The number of bytes of the first character; 0 if it is not UTF-8 (RFC 3629). Requires: not
/// empty.
std::size_t length_of_character(std::string_view text);

/// Whether all of the text is UTF-8.
bool is_utf8(std::string_view text);

/// The ending of a file's name with its dot, in lower case: `.obj` for `Head.OBJ`; empty: no
/// ending.
std::string ending_of(const std::filesystem::path& file);

/// The folder that a file is in; empty: the current one.
std::string folder_of_file(const std::filesystem::path& file);

/// The name of a file as seen from a folder; an empty one is the current folder. Where the way
/// leads over another folder, links are resolved.
std::string path_from(const std::filesystem::path& folder, const std::filesystem::path& file);

}  // namespace pliant
