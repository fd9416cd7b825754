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

}  // namespace

// A factor with the matrix that it is of.
struct FactoredMatrix::FactorItem final : Shelf::Item {
  SparseMatrix matrix;
  std::unique_ptr<const SparseFactor> factor = {};
};

Result<void> FactoredMatrix::take(long size, std::size_t bytes) {
  if (memory_.try_resize(bytes)) return {};
  factor_.reset();
  return fail(factor_too_large(size, memory_.complaint(bytes)));
}

Result<void> FactoredMatrix::take_factor(long size, const SparseFactor& factor) {
  return take(size, bytes_to_factorize * size + factor.bytes() + factor.work_bytes());
}

Result<void> FactoredMatrix::keep_factor(long size) {
  return take(size, bytes_to_factorize * size + factor_->bytes());
}

Result<void> FactoredMatrix::factor(const SparseMatrix& matrix, bool has_same_pattern) try {
  const long size = matrix.cols();
  if (!has_same_pattern || !factor_ || !is_analyzed_) {
    // Frees the old factor first, to make room for the new one.
    factor_.reset();
    factor_ = make_sparse_factor(choice_, context_);
    is_analyzed_ = false;
    if (auto taken = take(size, bytes_to_analyze * size); !taken) return taken;
  }
  const Hash key = context_.shelf ? key_of(matrix) : Hash();
  if (context_.shelf) {
    const auto item = context_.shelf->find<FactorItem>(key, [&](const FactorItem& one) {
      return matrix_bytes(one.matrix) == matrix_bytes(matrix);
    });
    if (item) {
      // Reserves what making it would.
      if (auto taken = take_factor(size, *item->factor); !taken) return taken;
      factor_->share(*item->factor);
      return keep_factor(size);
    }
  }
  if (!is_analyzed_) {
    if (is_stopped(context_.should_stop)) return interrupted();
    ++counts_.analyses;
    if (auto analyzed = factor_->analyze(matrix); !analyzed) return analyzed;
    is_analyzed_ = true;
  }
  if (auto taken = take_factor(size, *factor_); !taken) return taken;
  ++counts_.factorizations;
  if (auto factored = factor_->factorize(matrix, context_.should_stop); !factored) return factored;
  if (context_.shelf) keep(key, matrix);
  return keep_factor(size);
} catch (const std::bad_alloc&) {  // the only way in which Eigen reports it
  return fail(no_memory_for_factor(matrix.cols()));
}

// All that a factor depends on.
Hash FactoredMatrix::key_of(const SparseMatrix& matrix) const {
  HashStream stream;
  stream.add("factor of ");
  stream.add(name_of(choice_));
  for (const std::string_view bytes : matrix_bytes(matrix)) stream.add(bytes);
  return stream.hash();
}

void FactoredMatrix::keep(const Hash& key, const SparseMatrix& matrix) try {
  auto item = std::make_shared<FactorItem>();
  auto factor = make_sparse_factor(choice_, context_);
  if (!factor->share(*factor_)) return;
  item->factor = std::move(factor);
  item->matrix = matrix;
  std::size_t bytes = factor_->bytes();
  for (const std::string_view part : matrix_bytes(matrix)) bytes += part.size();
  context_.shelf->keep(key, std::move(item), bytes);
} catch (const std::bad_alloc&) {  // a shelf is not needed
}

Result<Field> FactoredMatrix::solve(const Field& right_hand_sides) try {
  PLIANT_EXPECTS(factor_ != nullptr);
  return factor_->solve(right_hand_sides);
} catch (const std::bad_alloc&) {
  return fail(no_memory_for_factor(right_hand_sides.rows()));
}

}  // namespace pliant
