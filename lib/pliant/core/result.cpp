#include "pliant/core/result.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <set>
#include <tuple>
#include <utility>

#include "pliant/core/text.hpp"

namespace pliant {
namespace {

std::string to_line(const Error& error) {
  std::string line;
  if (!error.file.empty()) {
    line += error.file + ':';
    if (error.line > 0) line += std::to_string(error.line) + ':';
    line += ' ';
  }
  return printable(line + "error: " + error.message);
}

// Requires: exactly one character of UTF-8.
char32_t code_point(std::string_view character) {
  const auto first = static_cast<unsigned char>(character[0]);
  if (character.size() == 1) return first;
  char32_t code = first & (0x7fu >> character.size());
  for (const char c : character.substr(1))
    code = code << 6 | (static_cast<unsigned char>(c) & 0x3f);
  return code;
}

bool acts_on_terminal(char32_t code) {
  return code < 0x20 || (code >= 0x7f && code < 0xa0) ||       // C0, DEL, C1
         code == 0x61c || code == 0x200e || code == 0x200f ||  // marks of writing direction
         (code >= 0x2028 && code <= 0x202e) ||  // line, paragraph, embeddings, overrides
         (code >= 0x2066 && code <= 0x2069) || code == 0xfeff;
}

void append_escaped(std::string_view bytes, std::string& line) {
  constexpr const char* digits = "0123456789abcdef";
  for (const char c : bytes) {
    const auto code = static_cast<unsigned char>(c);
    line += {'\\', 'x', digits[code >> 4], digits[code & 15]};
  }
}

}  // namespace

std::string printable(std::string_view text) {
  std::string line;
  while (!text.empty()) {
    const std::size_t size = length_of_character(text);
    const std::string_view character = text.substr(0, std::max<std::size_t>(size, 1));
    if (size > 0 && !acts_on_terminal(code_point(character))) {
      line += character;
    } else {
      append_escaped(character, line);
    }
    text.remove_prefix(character.size());
  }
  return line;
}

std::vector<std::string> to_lines(const Error& error) {
  std::vector<std::string> lines{to_line(error)};
  for (const Error& other : error.others) lines.push_back(to_line(other));
  return lines;
}

std::vector<Error> sorted(std::vector<Error> errors, std::string_view file) {
  std::vector<Error> all;
  for (Error& error : errors) {
    std::vector<Error> others = std::exchange(error.others, {});
    all.push_back(std::move(error));
    std::move(others.begin(), others.end(), std::back_inserter(all));
  }
  const auto place = [&](const Error& error) {
    return std::tuple(error.file != file, std::string_view(error.file), error.line);
  };
  std::stable_sort(all.begin(), all.end(),
                   [&](const Error& a, const Error& b) { return place(a) < place(b); });
  std::set<std::tuple<std::string_view, int, std::string_view>> seen;
  std::vector<Error> distinct;
  for (const Error& error : all) {
    if (seen.emplace(error.file, error.line, error.message).second) distinct.push_back(error);
  }
  return distinct;
}

Error as_one(std::vector<Error> errors, std::string_view file) {
  std::vector<Error> all = sorted(std::move(errors), file);
  Error first = std::move(all.front());
  first.others.assign(std::make_move_iterator(all.begin() + 1), std::make_move_iterator(all.end()));
  return first;
}

}  // namespace pliant
