#pragma once

#include <cstddef>

namespace pliant {

/// One block of numbers, aligned to a cache line; from some megabytes on in large pages if the
/// system has them, because a table of small pages has too few entries for one page per row of a
/// plate. Internal to plate.
class NumberBlock {
 public:
  NumberBlock() = default;
  /// Not initialised. Throws std::bad_alloc.
  explicit NumberBlock(std::size_t count);
  NumberBlock(const NumberBlock&) = delete;
  NumberBlock(NumberBlock&& other) noexcept;
  NumberBlock& operator=(NumberBlock&& other) noexcept;
  ~NumberBlock();

  double* begin() const { return begin_; }
  std::size_t count() const { return count_; }

  static constexpr std::size_t line = 64;  ///< bytes of a cache line, and of the widest vector

 private:
  double* begin_ = nullptr;
  std::size_t count_ = 0;
};

}  // namespace pliant
