#pragma once

#include <cstddef>
#include <iterator>

namespace pliant {

/// A range of integer frames: `for (int frame : simulation.frames())`. Instead of std::views::iota,
/// which Clang 14 cannot compile with GCC 12's library.
class FrameSequence {
 public:
  class Iterator {
   public:
    using iterator_category = std::forward_iterator_tag;
    using value_type = int;
    using difference_type = std::ptrdiff_t;
    using pointer = const int*;
    using reference = int;

    Iterator() = default;
    explicit Iterator(long frame) : frame_(frame) {}

    int operator*() const { return static_cast<int>(frame_); }
    Iterator& operator++() {
      ++frame_;
      return *this;
    }
    Iterator operator++(int) { return Iterator(frame_++); }

    friend bool operator==(const Iterator&, const Iterator&) = default;

   private:
    long frame_ = 0;  // long, since the end iterator may exceed the range of int
  };

  /// Both ends included. Requires: first <= last + 1.
  FrameSequence(int first, int last) : first_(first), last_(last) {}

  Iterator begin() const { return Iterator(first_); }
  Iterator end() const { return Iterator(long{last_} + 1); }
  std::size_t size() const { return static_cast<std::size_t>(long{last_} + 1 - first_); }

 private:
  int first_;
  int last_;
};

}  // namespace pliant
