#pragma once

#include <atomic>
#include <cstddef>
#include <limits>
#include <string>

namespace pliant {

/// How much memory the large parts of a run may use together. Each part reserves the memory it
/// needs before it allocates. Thread-safe.
class MemoryBudget {
 public:
  explicit MemoryBudget(std::size_t bytes = std::numeric_limits<std::size_t>::max());
  MemoryBudget(const MemoryBudget&) = delete;
  MemoryBudget& operator=(const MemoryBudget&) = delete;

  std::size_t total() const { return total_; }     ///< [bytes]
  std::size_t available() const { return free_; }  ///< not reserved by any share [bytes]

 private:
  friend class MemoryShare;

  std::size_t total_;
  std::atomic<std::size_t> free_;
};

/// The memory that one part of a run has reserved from a budget, until the share is destroyed.
class MemoryShare {
 public:
  /// The budget must outlive the share; null: no limit.
  explicit MemoryShare(MemoryBudget* budget) : budget_(budget) {}
  MemoryShare(MemoryShare&& other) noexcept;
  MemoryShare& operator=(MemoryShare&&) = delete;
  ~MemoryShare() { give_back(); }

  /// Reserves or returns memory, so that the share is `bytes`. False, with nothing changed, if the
  /// budget has less.
  [[nodiscard]] bool try_resize(std::size_t bytes);

  std::size_t bytes() const { return bytes_; }

  /// The largest size that `try_resize` would accept now. [bytes]
  std::size_t available() const;

  /// "takes 3.2 GB, more than the 1.1 GB left of the 2 GB allowed". Requires: there is a budget.
  std::string complaint(std::size_t bytes) const;

 private:
  void give_back();

  MemoryBudget* budget_;
  std::size_t bytes_ = 0;
};

/// A number of bytes for a reader: "640 B", "1.25 MB", "17.6 GB"; three digits, powers of 1000.
std::string bytes_text(std::size_t bytes);

}  // namespace pliant
