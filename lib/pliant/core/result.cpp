#include "pliant/core/result.hpp"

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

}  // namespace

std::string printable(std::string_view text) {
  constexpr const char* digits = "0123456789abcdef";
  std::string line;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code >= 0x20 && code != 0x7f) {
      line += c;
    } else {
      line += {'\\', 'x', digits[code >> 4], digits[code & 15]};
    }
  }
  return line;
}

std::vector<std::string> to_lines(const Error& error) {
  std::vector<std::string> lines{to_line(error)};
  for (const Error& other : error.others) lines.push_back(to_line(other));
  return lines;
}

}  // namespace pliant
