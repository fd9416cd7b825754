#pragma once

#include <atomic>
#include <cstddef>
#include <limits>
#include <string>

namespace pliant {

/// How much memory the large parts of a run may take together. Each says what it needs before it
/// allocates. Several threads may use one.
class MemoryBudget {
 public:
  explicit MemoryBudget(std::size_t bytes = std::numeric_limits<std::size_t>::max());
  MemoryBudget(const MemoryBudget&) = delete;
  MemoryBudget& operator=(const MemoryBudget&) = delete;

  std::size_t total() const { return total_; }     ///< [bytes]
  std::size_t available() const { return free_; }  ///< that nobody has taken [bytes]

 private:
  friend class MemoryShare;

  std::size_t total_;
  std::atomic<std::size_t> free_;
};

/// What one part of a run has taken out of a budget, until it is destroyed.
class MemoryShare {
 public:
  /// The budget outlives the share; none means no limit.
  explicit MemoryShare(MemoryBudget* budget) : budget_(budget) {}
  MemoryShare(MemoryShare&& other) noexcept;
  MemoryShare& operator=(MemoryShare&&) = delete;
  ~MemoryShare() { give_back(); }

  /// Takes or gives back, so that the share is `bytes`. False, and nothing changed, where the
  /// budget has less.
  [[nodiscard]] bool try_resize(std::size_t bytes);

  std::size_t bytes() const { return bytes_; }

  /// What `try_resize` could take now. [bytes]
  std::size_t available() const;

  /// "takes 3.2 GB, more than the 1.1 GB left of the 2 GB allowed". Requires: there is a budget.
  std::string complaint(std::size_t bytes) const;

 private:
  void give_back();

  MemoryBudget* budget_;
  std::size_t bytes_ = 0;
};

/// A number of bytes to read: "640 B", "1.25 MB", "17.6 GB"; three digits, powers of 1000.
std::string bytes_text(std::size_t bytes);

}  // namespace pliant
