#include "pliant/core/shortened.hpp"

#include <algorithm>

namespace pliant {

std::string shortened(std::string_view text, std::size_t longest) {
  if (text.size() <= longest) return std::string(text);
  constexpr std::string_view rest = "…";
  std::size_t end = longest - rest.size();
  while (end > 0 && (text[end] & '\xc0') == '\x80') --end;
  return std::string(text.substr(0, end)).append(rest);
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t longest = 63;  // bytes; fits on a line of a terminal
  std::string shown = shortened(text, longest);
  std::ranges::replace_if(
      shown, [](char c) { return (c >= 0 && c < ' ') || c == '\x7f'; }, ' ');
  return '"' + shown + '"';
}

std::string in_words(std::span<const std::string> words) {
  std::string text;
  for (std::size_t k = 0; k < words.size(); ++k)
    text += (k == 0 ? "" : k + 1 < words.size() ? ", " : " and ") + words[k];
  return text;
}

}  // namespace pliant
