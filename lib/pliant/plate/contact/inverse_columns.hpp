#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"

namespace pliant {

/// Columns of the inverse of a plate's matrix, kept for as long as the matrix is the same. Each is
/// a function of the matrix and its unknown alone. Internal to plate.
class InverseColumns {
 public:
  /// Solves for three right-hand sides, which leave no mark on each other (#unknowns x 3).
  using Solve = std::function<Result<Field>(const Field& forces)>;

  explicit InverseColumns(const RunContext& context) : context_(context), share_(context.memory) {}

  /// The matrix is another one.
  void forget();

  /// Has those of some unknowns, ascending, of so many. Errors: those of `solve`; OutOfMemory;
  /// Interrupted.
  Result<void> take(std::span<const int> unknowns, Eigen::Index size, const Solve& solve);

  /// The column of an unknown (#unknowns). Requires: it was taken last.
  const double* of(int unknown) const { return columns_.at(unknown).data(); }

  std::size_t memory() const { return share_.bytes(); }

 private:
  Result<void> reserve(std::span<const int> unknowns, Eigen::Index size);

  RunContext context_;
  MemoryShare share_;
  std::map<int, std::vector<double>> columns_;
};

}  // namespace pliant
