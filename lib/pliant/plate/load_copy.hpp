#pragma once

#include <cstddef>

#include "pliant/core/memory_budget.hpp"
#include "pliant/core/result.hpp"
#include "pliant/plate/backward_euler.hpp"

namespace pliant {

/// A problem's load, to be changed beside the rim: what the solvers in sine space begin an interval
/// with. Keeps its memory from one to the next. Not for other rooms.
class LoadCopy {
 public:
  /// Memory out of `budget`, which outlives it; none: no limit.
  explicit LoadCopy(MemoryBudget* budget) : memory_(budget) {}

  /// Takes the load of a problem. Errors: OutOfMemory.
  Result<void> take(const PlateProblem& problem);

  Field& nodes() { return nodes_; }  ///< #nodes x 3
  std::size_t memory() const { return memory_.bytes(); }

 private:
  MemoryShare memory_;
  Field nodes_;
};

}  // namespace pliant
