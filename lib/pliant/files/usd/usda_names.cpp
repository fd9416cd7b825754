#include "pliant/files/usd/usda_names.hpp"

#include <fmt/format.h>

namespace pliant {

std::string UsdaNames::take(std::string_view name) {
  std::string plain;
  for (const char c : name) {
    const bool is_digit = c >= '0' && c <= '9';
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    if (is_digit && plain.empty()) plain += '_';
    plain += is_digit || is_letter ? c : '_';
  }
  if (plain.empty()) plain = "_";
  std::string free = plain;
  int& next = next_suffix_.try_emplace(plain, 2).first->second;
  while (!taken_.insert(free).second) free = fmt::format("{}_{}", plain, next++);
  return free;
}

std::string usda_string(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += (c >= 0 && c < ' ') || c == '\x7f' ? '_' : c;
  }
  return quoted + '"';
}

}  // namespace pliant
