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
  return line + "error: " + error.message;
}

}  // namespace

std::vector<std::string> to_lines(const Error& error) {
  std::vector<std::string> lines{to_line(error)};
  for (const Error& other : error.others) lines.push_back(to_line(other));
  return lines;
}

}  // namespace pliant
