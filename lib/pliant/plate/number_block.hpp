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

/// Hands out arrays of one block, each on its own cache line; with a null block it only counts.
class Carver {
 public:
  explicit Carver(double* block) : block_(block) {}

  double* take(std::size_t count) {
    double* const place = block_ ? block_ + used_ : nullptr;
    used_ += (count + unit - 1) / unit * unit;
    return place;
  }

  /// With an odd number of lines after whole pages, so that arrays that are read together do not
  /// compete for the same cache sets.
  double* take_apart(std::size_t count) {
    double* const place = take(count);
    if (count >= 512) used_ += (512 - used_ % 512) % 512 + unit * (1 + 2 * (arrays_++ % 29));
    return place;
  }

  std::size_t used() const { return used_; }

 private:
  static constexpr std::size_t unit = NumberBlock::line / sizeof(double);

  double* block_;
  std::size_t used_ = 0;
  std::size_t arrays_ = 0;  // that are apart
};

}  // namespace pliant
