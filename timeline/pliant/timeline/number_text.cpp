#include "pliant/timeline/number_text.hpp"

#include <array>
#include <charconv>

namespace pliant::timeline {

std::string number_text(double number) {
  std::array<char, 32> text = {};  // the longest shortest form has 24 characters
  const auto end = std::to_chars(text.data(), text.data() + text.size(), number).ptr;
  return {text.data(), end};
}

}  // namespace pliant::timeline
