#pragma once

#include <cstddef>
#include <memory>

#include "pliant/core/hash.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/plate/sparse/sparse_factor.hpp"

namespace pliant {

/// A sparse matrix that is factored again and again: keeps what depends on its pattern only, and
/// reserves memory before it is used. A factor of an equal matrix is taken from the shelf, if there
/// is one; what is reserved is the same. Internal to plate.
class FactoredMatrix {
 public:
  /// Requires: the choice is available.
  FactoredMatrix(SolverChoice choice, const RunContext& context)
      : choice_(choice), context_(context), memory_(context.memory) {}

  /// Factors a matrix, of which the upper triangle is given. `has_same_pattern`: its pattern is
  /// that of the last one that was factored. Errors: OutOfMemory; SolverFailed if it is not
  /// positive definite; Interrupted, but not while the unknowns are ordered.
  Result<void> factor(const SparseMatrix& matrix, bool has_same_pattern);

  /// Solves for three right-hand sides (#rows x 3). Requires: `factor` succeeded last.
  Result<Field> solve(const Field& right_hand_sides);

  SolverCounts counts() const { return counts_; }
  void count_solve() { ++counts_.solves; }
  std::size_t memory() const { return memory_.bytes(); }

 private:
  struct FactorItem;

  Result<void> take(long size, std::size_t bytes);
  Result<void> take_factor(long size, const SparseFactor& factor);
  Result<void> keep_factor(long size);
  Hash key_of(const SparseMatrix& matrix) const;
  void keep(const Hash& key, const SparseMatrix& matrix);

  SolverChoice choice_;
  RunContext context_;
  MemoryShare memory_;
  std::unique_ptr<SparseFactor> factor_;
  bool is_analyzed_ = false;  // by `factor_`
  SolverCounts counts_;
};

}  // namespace pliant
