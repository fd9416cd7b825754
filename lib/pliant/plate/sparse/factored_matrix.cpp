#include "pliant/plate/sparse/factored_matrix.hpp"

#include <array>
#include <new>
#include <string_view>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/core/hash_stream.hpp"
#include "pliant/core/shelf.hpp"
#include "pliant/plate/solver_errors.hpp"
#include "pliant/plate/sparse/matrix_bytes.hpp"

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

// A factor with the matrix that it is of.
struct FactoredMatrix::FactorItem final : Shelf::Item {
  SparseMatrix matrix;
  std::unique_ptr<const SparseFactor> factor = {};  // null: it has supernodes
  std::shared_ptr<const SupernodalFactor::Numbers> supernodes = {};
  std::size_t entries = 0;
  std::size_t supernode_bytes = 0;
};

Result<void> FactoredMatrix::take(long size, std::size_t bytes) {
  if (memory_.try_resize(bytes)) return {};
  factor_.reset();
  return fail(factor_too_large(size, memory_.complaint(bytes)));
}

Result<void> FactoredMatrix::take_factor(long size, std::size_t entries) {
  has_supernodes_ = false;
  if (supernodes_) supernodes_->release();
  return take(size, bytes_to_factorize * size + bytes_of_entry * entries);
}

Result<void> FactoredMatrix::factor(long size, bool has_same_pattern,
                                    const std::function<Result<SparseMatrix>()>& assemble) try {
  if (!has_same_pattern || !factor_ || !is_analyzed_) {
    // Frees the old factor first, to make room for the new one.
    factor_.reset();
    factor_ = make_sparse_factor(choice_);
    is_analyzed_ = false;
    if (auto taken = take(size, bytes_to_analyze * size); !taken) return taken;
  }
  const Result<SparseMatrix> assembled = assemble();
  if (!assembled) return fail(assembled.error());
  const SparseMatrix& matrix = *assembled;
  const Hash key = shelf_ ? key_of(matrix) : Hash();
  if (shelf_) {
    const auto item = shelf_->find<FactorItem>(key, [&](const FactorItem& one) {
      return matrix_bytes(one.matrix) == matrix_bytes(matrix);
    });
    if (item) return use(size, *item);
  }
  if (!is_analyzed_) {
    if (is_stopped(should_stop_)) return interrupted();
    ++counts_.analyses;
    if (auto analyzed = factor_->analyze(matrix); !analyzed) return analyzed;
    is_analyzed_ = true;
  }
  const std::size_t entries = factor_->entries();
  if (auto taken = take_factor(size, entries); !taken) return taken;
  ++counts_.factorizations;
  if (auto factored = factor_->factorize(matrix, should_stop_); !factored) return factored;
  if (supernodes_) {
    if (auto joined = join_columns(size); !joined) return joined;
  }
  if (shelf_) keep(key, matrix, entries);
  return {};
} catch (const std::bad_alloc&) {  // the only way in which Eigen reports it
  return fail(no_memory_for_factor(size));
}

// All that a factor depends on.
Hash FactoredMatrix::key_of(const SparseMatrix& matrix) const {
  HashStream stream;
  stream.add(supernodes_ ? "supernodes of " : "factor of ");
  stream.add(name_of(choice_));
  for (const std::string_view bytes : matrix_bytes(matrix)) stream.add(bytes);
  return stream.hash();
}

// Reserves what making it would.
Result<void> FactoredMatrix::use(long size, const FactorItem& item) {
  if (auto taken = take_factor(size, item.entries); !taken) return taken;
  if (!item.supernodes) {
    factor_->share(*item.factor);
    return {};
  }
  const std::size_t bytes = item.supernode_bytes;
  if (auto taken = take(size, memory_.bytes() + bytes); !taken) return taken;
  supernodes_->use(item.supernodes);
  has_supernodes_ = true;
  factor_->release();
  return take(size, bytes_to_factorize * size + bytes);
}

void FactoredMatrix::keep(const Hash& key, const SparseMatrix& matrix, std::size_t entries) try {
  auto item = std::make_shared<FactorItem>();
  item->entries = entries;
  if (has_supernodes_) {
    item->supernodes = supernodes_->numbers();
    item->supernode_bytes = memory_.bytes() - bytes_to_factorize * matrix.cols();
  } else {
    auto factor = make_sparse_factor(choice_);
    if (!factor->share(*factor_)) return;
    item->factor = std::move(factor);
  }
  item->matrix = matrix;
  std::size_t bytes = has_supernodes_ ? item->supernode_bytes : bytes_of_entry * entries;
  for (const std::string_view part : matrix_bytes(matrix)) bytes += part.size();
  shelf_->keep(key, std::move(item), bytes);
} catch (const std::bad_alloc&) {  // a shelf is not needed
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
