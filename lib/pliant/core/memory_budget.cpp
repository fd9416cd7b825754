#include "pliant/core/memory_budget.hpp"

#include <utility>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"

namespace pliant {

MemoryBudget::MemoryBudget(std::size_t bytes) : total_(bytes), free_(bytes) {}

MemoryShare::MemoryShare(MemoryShare&& other) noexcept
    : budget_(std::exchange(other.budget_, nullptr)), bytes_(std::exchange(other.bytes_, 0)) {}

bool MemoryShare::try_resize(std::size_t bytes) {
  if (!budget_) {
    // No limit.
  } else if (bytes > bytes_) {
    const std::size_t more = bytes - bytes_;
    std::size_t free = budget_->free_.load();
    do {
      if (free < more) return false;
    } while (!budget_->free_.compare_exchange_weak(free, free - more));
  } else {
    budget_->free_ += bytes_ - bytes;
  }
  bytes_ = bytes;
  return true;
}

std::size_t MemoryShare::available() const {
  return budget_ ? budget_->available() + bytes_ : std::numeric_limits<std::size_t>::max();
}

void MemoryShare::give_back() {
  const std::size_t bytes = std::exchange(bytes_, 0);
  if (budget_) budget_->free_ += bytes;
}

std::string MemoryShare::complaint(std::size_t bytes) const {
  PLIANT_EXPECTS(budget_);
  return fmt::format("needs {}, more than the {} left of the {} allowed", bytes_text(bytes),
                     bytes_text(budget_->available() + bytes_), bytes_text(budget_->total()));
}

std::string bytes_text(std::size_t bytes) {
  constexpr const char* units[] = {"B", "kB", "MB", "GB", "TB", "PB", "EB"};
  auto amount = static_cast<double>(bytes);
  int unit = 0;
  for (; amount >= 999.5 && unit < 6; ++unit) amount /= 1000;
  return fmt::format("{:.3g} {}", amount, units[unit]);
}

}  // namespace pliant
