#include <algorithm>

#include "pliant/scene/text/markup.hpp"
#include "pliant/scene/text/text.hpp"

namespace pliant::xml {
namespace {

constexpr std::size_t searched = std::size_t{1} << 16U;  // bytes, without asking

}  // namespace

std::size_t find_from(std::string_view text, std::string_view what, std::size_t at,
                      Findings& findings) {
  for (; at < text.size(); at += searched) {
    const std::size_t found = text.substr(at, searched + what.size() - 1).find(what);
    if (found != std::string_view::npos) return at + found;
    if (findings.is_over(searched)) break;
  }
  return std::string_view::npos;
}

std::size_t first_not_blank(std::string_view text, std::size_t at, Findings& findings) {
  while (at < text.size()) {
    const std::string_view ahead = text.substr(at, searched);
    const std::size_t count = std::min(ahead.find_first_not_of(blanks), ahead.size());
    at += count;
    if (count < ahead.size() || findings.is_over(count)) return at;
  }
  return at;
}

}  // namespace pliant::xml
