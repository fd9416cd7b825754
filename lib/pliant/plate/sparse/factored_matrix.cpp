#include "pliant/plate/sparse/factored_matrix.hpp"

#include <new>

#include "pliant/core/expects.hpp"
#include "pliant/plate/solver_errors.hpp"

namespace pliant {
namespace {

// Per unknown, for the analysis: the matrix's upper triangle (7 entries of 12 bytes) and the full
// pattern that the ordering copies, with elbow room and a dozen integers. For the factorisation,
// beside the factor: the matrix, its permuted copy, and right-hand sides, solution and workspace
// of three columns each.
constexpr std::size_t bytes_to_analyze = 250;
constexpr std::size_t bytes_to_factorize = 350;
constexpr std::size_t bytes_of_entry = 12;  // of the factor: a double and an index

}  // namespace

Result<void> FactoredMatrix::take(long size, std::size_t bytes) {
  if (memory_.try_resize(bytes)) return {};
  factor_.reset();
  return fail(factor_too_large(size, memory_.complaint(bytes)));
}

Result<void> FactoredMatrix::factor(long size, bool has_same_pattern,
                                    const std::function<SparseMatrix()>& assemble) try {
  if (!has_same_pattern || !factor_) {
    has_same_pattern = false;
    // Frees the old factor first, to make room for the new one.
    factor_.reset();
    factor_ = make_sparse_factor(choice_);
    if (auto taken = take(size, bytes_to_analyze * size); !taken) return taken;
  }
  const SparseMatrix matrix = assemble();
  if (!has_same_pattern) {
    ++counts_.analyses;
    if (auto analyzed = factor_->analyze(matrix); !analyzed) return analyzed;
  }
  has_supernodes_ = false;
  if (supernodes_) supernodes_->release();
  const std::size_t bytes = bytes_to_factorize * size + bytes_of_entry * factor_->entries();
  if (auto taken = take(size, bytes); !taken) return taken;
  ++counts_.factorizations;
  if (auto factored = factor_->factorize(matrix, should_stop_); !factored) return factored;
  return supernodes_ ? join_columns(size) : Result<void>();
} catch (const std::bad_alloc&) {  // the only way in which Eigen reports it
  return fail(no_memory_for_factor(size));
}

Result<void> FactoredMatrix::join_columns(long size) {
  const auto columns = factor_->columns();
  if (!columns) return {};
  const std::size_t bytes = supernodes_->plan(*columns);
  if (auto taken = take(size, memory_.bytes() + bytes); !taken) return taken;
  supernodes_->take(*columns);
  has_supernodes_ = true;
  factor_->release();
  return take(size, bytes_to_factorize * size + bytes);
}

Result<Field> FactoredMatrix::solve(const Field& right_hand_sides) try {
  PLIANT_EXPECTS(factor_ != nullptr);
  return has_supernodes_ ? Result<Field>(supernodes_->solve(right_hand_sides))
                         : factor_->solve(right_hand_sides);
} catch (const std::bad_alloc&) {
  return fail(no_memory_for_factor(right_hand_sides.rows()));
}

}  // namespace pliant
