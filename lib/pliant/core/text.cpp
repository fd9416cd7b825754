#include "pliant/core/text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace pliant {
namespace {

// from_chars rejects a leading plus; the character after it must not be a second sign.
std::optional<std::string_view> without_plus(std::string_view text) {
  if (!text.starts_with('+')) return text;
  text.remove_prefix(1);
  if (text.starts_with('-') || text.starts_with('+')) return std::nullopt;
  return text;
}

}  // namespace

std::optional<double> to_number(std::string_view text) {
  const auto digits = without_plus(text);
  if (!digits) return std::nullopt;
  double number = 0;
  const char* end = digits->data() + digits->size();
  const auto [last, error] = std::from_chars(digits->data(), end, number);
  if (error != std::errc{} || last != end || !std::isfinite(number)) return std::nullopt;
  return number;
}

double with_digits(double number, int digits) {
  if (digits <= 0 || !std::isfinite(number)) return number;
  std::array<char, 64> text;
  const int behind_point = std::min(digits, 17) - 1;
  const auto written = std::to_chars(text.data(), text.data() + text.size(), number,
                                     std::chars_format::scientific, behind_point);
  return to_number({text.data(), written.ptr}).value_or(number);
}

std::optional<int> to_integer(std::string_view text) {
  const auto digits = without_plus(text);
  if (!digits) return std::nullopt;
  int number = 0;
  const char* end = digits->data() + digits->size();
  const auto [last, error] = std::from_chars(digits->data(), end, number);
  if (error != std::errc{} || last != end) return std::nullopt;
  return number;
}

std::string ending_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return ending;
}

std::vector<std::string_view> words_of(std::string_view text, std::string_view blanks) {
  std::vector<std::string_view> words;
  for (std::string_view word = next_word(text, blanks); !word.empty();
       word = next_word(text, blanks))
    words.push_back(word);
  return words;
}

std::size_t length_of_character(std::string_view text) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t size = first >= 0xc2 && first < 0xe0   ? 2
                           : first >= 0xe0 && first < 0xf0 ? 3
                           : first >= 0xf0 && first < 0xf5 ? 4
                                                           : 0;
  if (size == 0 || text.size() < size) return 0;
  for (std::size_t k = 1; k < size; ++k)
    if ((byte(k) & 0xc0) != 0x80) return 0;
  // Overlong encodings, surrogates, code points beyond U+10FFFF.
  const bool is_wrong = (first == 0xe0 && byte(1) < 0xa0) || (first == 0xed && byte(1) >= 0xa0) ||
                        (first == 0xf0 && byte(1) < 0x90) || (first == 0xf4 && byte(1) >= 0x90);
  return is_wrong ? 0 : size;
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t size = length_of_character(text);
    if (size == 0) return false;
    text.remove_prefix(size);
  }
  return true;
}

std::string folder_of_file(const std::filesystem::path& file) {
  return file.parent_path().string();
}

std::string path_from(const std::filesystem::path& folder, const std::filesystem::path& file) {
  const bool leads_up = std::find(folder.begin(), folder.end(), "..") != folder.end();
  if (!leads_up && folder.is_absolute() == file.is_absolute()) {
    const std::filesystem::path below = file.lexically_relative(folder.empty() ? "." : folder);
    if (!below.empty() && *below.begin() != "..") return below.string();
  }
  std::error_code unknown;
  const auto real = [&](const std::filesystem::path& path) {
    const std::filesystem::path whole = std::filesystem::absolute(path, unknown);
    return unknown ? path : std::filesystem::weakly_canonical(whole, unknown);
  };
  const std::filesystem::path base = real(folder.empty() ? "." : folder), there = real(file);
  return (unknown ? file : there.lexically_proximate(base)).string();
}

}  // namespace pliant
