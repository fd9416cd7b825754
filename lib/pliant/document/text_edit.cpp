#include "pliant/document/text_edit.hpp"

#include <algorithm>

#include "pliant/core/expects.hpp"

namespace pliant::edit {

std::string made(const std::string& text, const EditBatch& batch) {
  std::string result;
  result.reserve(text.size());
  std::size_t copied = 0;
  for (const TextEdit& edit : batch) {
    PLIANT_EXPECTS(edit.at >= copied && edit.at + edit.removed.size() <= text.size());
    PLIANT_EXPECTS(text.compare(edit.at, edit.removed.size(), edit.removed) == 0);
    result.append(text, copied, edit.at - copied);
    result += edit.inserted;
    copied = edit.at + edit.removed.size();
  }
  return result.append(text, copied);
}

EditBatch reversed(const EditBatch& batch) {
  EditBatch result;
  result.reserve(batch.size());
  std::size_t at = 0;  // in the changed text, of the byte `copied` of the old one
  std::size_t copied = 0;
  for (const TextEdit& edit : batch) {
    at += edit.at - copied;
    result.push_back({.at = at, .removed = edit.inserted, .inserted = edit.removed});
    at += edit.inserted.size();
    copied = edit.at + edit.removed.size();
  }
  return result;
}

TextEdit difference(std::string_view from, std::string_view to) {
  // Whether a character ends before a byte.
  const auto ends = [](std::string_view text, std::size_t at) {
    return at == text.size() || (static_cast<unsigned char>(text[at]) & 0xC0U) != 0x80U;
  };
  const std::size_t shorter = std::min(from.size(), to.size());
  std::size_t begin =
      std::mismatch(from.begin(), from.begin() + shorter, to.begin()).first - from.begin();
  while (begin > 0 && !(ends(from, begin) && ends(to, begin))) --begin;
  const auto last = std::mismatch(from.rbegin(), from.rbegin() + (shorter - begin), to.rbegin());
  std::size_t end = last.first - from.rbegin();  // bytes that both end with
  while (end > 0 && !ends(from, from.size() - end)) --end;
  return {.at = begin,
          .removed = std::string(from.substr(begin, from.size() - end - begin)),
          .inserted = std::string(to.substr(begin, to.size() - end - begin))};
}

}  // namespace pliant::edit
