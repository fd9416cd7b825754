#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace pliant {

/// Many short texts, one behind the other in one block: millions of them take a third of the memory
/// of strings, and are freed at once.
class TextList {
 public:
  std::size_t size() const { return ends_.size(); }
  bool empty() const { return ends_.empty(); }

  /// Valid until the list is changed or destroyed, also in another one that it was moved to.
  std::string_view operator[](std::size_t k) const {
    const std::size_t begin = k == 0 ? 0 : ends_[k - 1];
    return {bytes_.data() + begin, ends_[k] - begin};
  }

  void push_back(std::string_view text) {
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    ends_.push_back(bytes_.size());
  }

 private:
  std::vector<char> bytes_;
  std::vector<std::size_t> ends_;  // of each text in `bytes_`
};

}  // namespace pliant
