#include "pliant/core/shortened.hpp"

namespace pliant {

std::string shortened(std::string_view text, std::size_t longest) {
  if (text.size() <= longest) return std::string(text);
  constexpr std::string_view rest = "…";
  std::size_t end = longest - rest.size();
  while (end > 0 && (text[end] & '\xc0') == '\x80') --end;
  return std::string(text.substr(0, end)).append(rest);
}

}  // namespace pliant
