#include "pliant/document/text_edit.hpp"

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

}  // namespace pliant::edit
