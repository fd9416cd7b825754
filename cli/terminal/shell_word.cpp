#include "cli/terminal/shell_word.hpp"

#include <fmt/format.h>

#include "pliant/core/result.hpp"

namespace pliant::cli {
namespace {

// In bash and zsh alike: the three digits end each number.
std::string ansi_word(std::string_view text) {
  std::string word = "$'";
  for (const char letter : text) {
    const auto byte = static_cast<unsigned char>(letter);
    if (byte < 0x20 || byte >= 0x7f)
      word += fmt::format("\\{:03o}", byte);
    else if (letter == '\'' || letter == '\\')
      word += fmt::format("\\{}", letter);
    else
      word += letter;
  }
  return word + "'";
}

}  // namespace

std::string shell_word(std::string_view text) {
  if (printable(text) != text) return ansi_word(text);
  constexpr std::string_view plain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_@%+=:,./-";
  // A word that begins with = is the path of a program in zsh.
  if (!text.empty() && text.front() != '=' && text.find_first_not_of(plain) == std::string::npos)
    return std::string(text);
  std::string word = "'";
  for (const char letter : text)
    word += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  return word + "'";
}

std::string shell_line(std::span<const std::string> words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + shell_word(word);
  return line;
}

}  // namespace pliant::cli
