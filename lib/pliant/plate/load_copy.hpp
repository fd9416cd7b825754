#pragma once

#include <cstddef>

#include "pliant/core/memory_budget.hpp"
#include "pliant/core/result.hpp"
#include "pliant/plate/plate_problem.hpp"

namespace pliant {

/// A copy of a problem's load, to be changed beside the rim, from which the solvers in sine space
/// begin an interval. Its memory is reused for the next interval. Internal to plate.
class LoadCopy {
 public:
  /// Reserves memory from `budget`, which must outlive it; null: no limit.
  explicit LoadCopy(MemoryBudget* budget) : memory_(budget) {}

  /// Copies the load of a problem. Errors: OutOfMemory.
  Result<void> take(const PlateProblem& problem);

  Field& nodes() { return nodes_; }  ///< #nodes x 3
  std::size_t memory() const { return memory_.bytes(); }

 private:
  MemoryShare memory_;
  Field nodes_;
};

}  // namespace pliant
