#include "pliant/plate/number_block.hpp"

#include <new>
#include <utility>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace pliant {
namespace {

constexpr std::size_t large_page = std::size_t{2} << 20;

std::size_t bytes_of(std::size_t count) { return count * sizeof(double); }

bool is_large(std::size_t count) { return bytes_of(count) >= 2 * large_page; }

std::align_val_t alignment_of(std::size_t count) {
  return std::align_val_t{is_large(count) ? large_page : NumberBlock::line};
}

}  // namespace

NumberBlock::NumberBlock(std::size_t count)
    : begin_(static_cast<double*>(::operator new(bytes_of(count), alignment_of(count)))),
      count_(count) {
#ifdef MADV_HUGEPAGE
  // Only a hint: a refusal does no harm.
  if (is_large(count)) madvise(begin_, bytes_of(count), MADV_HUGEPAGE);
#endif
}

NumberBlock::NumberBlock(NumberBlock&& other) noexcept
    : begin_(std::exchange(other.begin_, nullptr)), count_(std::exchange(other.count_, 0)) {}

NumberBlock& NumberBlock::operator=(NumberBlock&& other) noexcept {
  std::swap(begin_, other.begin_);
  std::swap(count_, other.count_);
  return *this;
}

NumberBlock::~NumberBlock() {
  if (begin_) ::operator delete(begin_, alignment_of(count_));
}

}  // namespace pliant
