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

int LineCounter::count(std::size_t from, std::size_t to) const {
  return static_cast<int>(std::count(text_.begin() + from, text_.begin() + to, '\n'));
}

int LineCounter::line_of(std::size_t offset) {
  const auto [from, to] = std::minmax(offset, counted_);
  if (to - from > block_size) {
    const std::size_t block = offset / block_size;
    for (std::size_t k = lines_.size(); k <= block; ++k)
      lines_.push_back(lines_.back() + count((k - 1) * block_size, k * block_size));
    line_ = lines_[block] + count(block * block_size, offset);
  } else {
    line_ += offset < counted_ ? -count(from, to) : count(from, to);
  }
  counted_ = offset;
  return line_;
}

int LineCounter::column_of(std::size_t offset) const {
  const std::size_t line = text_.substr(0, offset).rfind('\n') + 1;  // 0 if there is none
  const bool has_mark = line == 0 && text_.starts_with(byte_order_mark);
  return static_cast<int>(offset - line - (has_mark ? byte_order_mark.size() : 0)) + 1;
}

}  // namespace pliant::xml
