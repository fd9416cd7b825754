#include "viewer/http_head.hpp"

#include <algorithm>

namespace pliant::viewer {
namespace {

bool is_plain(char byte) { return (byte >= ' ' && byte <= '~') || byte == '\t'; }

}  // namespace

const std::string* HttpHead::find(std::string_view name) const {
  const auto found = std::find_if(fields.begin(), fields.end(),
                                  [&](const HttpField& field) { return field.name == name; });
  return found == fields.end() ? nullptr : &found->value;
}

HeadScanner::State HeadScanner::take(char byte) {
  if (text_.size() == most_bytes_) return State::TooLarge;
  const bool is_after_return = !text_.empty() && text_.back() == '\r';
  text_ += byte;
  if (is_after_return) return byte == '\n' ? end_line() : State::Malformed;
  if (byte == '\r') return State::More;
  if (!is_plain(byte)) return State::Malformed;
  const bool is_blank = byte == ' ' || byte == '\t';
  return is_blank && text_.size() == line_begin_ + 1 ? State::Malformed : State::More;
}

HeadScanner::State HeadScanner::end_line() {
  const std::string_view line(text_.data() + line_begin_, text_.size() - line_begin_ - 2);
  line_begin_ = text_.size();
  if (lines_ == 0) {
    if (!line.ends_with(" HTTP/1.1")) return State::Malformed;
  } else if (line.empty()) {
    return State::Complete;
  }
  return ++lines_ > most_lines_ ? State::TooLarge : State::More;
}

}  // namespace pliant::viewer
