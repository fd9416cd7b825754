#include <algorithm>
#include <memory>

#include <cholmod.h>

#include "pliant/plate/solver_errors.hpp"
#include "pliant/plate/sparse/sparse_factor.hpp"

namespace pliant {
namespace {

// A factor frees itself with a workspace of its own, because it may outlive the one that it was
// made with.
std::shared_ptr<cholmod_factor> owned(cholmod_factor* factor) {
  return {factor, [](cholmod_factor* last) {
            cholmod_common common = {};
            cholmod_start(&common);
            cholmod_free_factor(&last, &common);
            cholmod_finish(&common);
          }};
}

/// CHOLMOD's workspace and settings, and everything allocated with them.
class CholmodFactor final : public SparseFactor {
 public:
  CholmodFactor() {
    cholmod_start(&common_);
    // Simplicial LDL^T in one order: no BLAS (whose kernels change with the CPU), no METIS (which
    // uses the process-wide rand), no choice by trial. Bit-identical everywhere. SPEC 10.
    common_.supernodal = CHOLMOD_SIMPLICIAL;
    common_.final_ll = 0;
    common_.nmethods = 1;
    common_.method[0].ordering = CHOLMOD_AMD;
    common_.postorder = 1;
    common_.grow2 = 0;  // a column has as much room as the analysis found, and no more
    common_.print = 0;
    common_.try_catch = 1;
  }
  ~CholmodFactor() override {
    cholmod_free_factor(&pattern_, &common_);
    for (cholmod_dense* dense : {solution_, workspace_y_, workspace_e_}) {
      cholmod_free_dense(&dense, &common_);
    }
    cholmod_finish(&common_);
  }

  Result<void> analyze(const SparseMatrix& matrix) override {
    factor_.reset();
    cholmod_free_factor(&pattern_, &common_);
    cholmod_sparse view = view_of(matrix);
    pattern_ = cholmod_analyze(&view, &common_);
    return check(matrix.rows());
  }

  std::size_t bytes() const override {
    constexpr std::size_t bytes_of_entry = sizeof(double) + sizeof(int);
    return bytes_of_entry * (factor_ ? factor_->nzmax : static_cast<std::size_t>(common_.lnz));
  }

  // What `cholmod_factorize` does, but some rows at a time.
  Result<void> factorize(const SparseMatrix& matrix, const StopRequest& should_stop) override {
    factor_.reset();
    cholmod_sparse* const ordered = in_order(matrix);
    if (ordered) factor_ = owned(cholmod_copy_factor(pattern_, &common_));
    bool is_stopped = false;
    // LDL^T, not packed: that would leave room for the diagonal alone, and each column would move
    // whenever it grows.
    if (factor_ && cholmod_change_factor(CHOLMOD_REAL, 0, 0, 0, 1, factor_.get(), &common_)) {
      constexpr std::size_t rows_at_a_time = 64;
      const auto size = static_cast<std::size_t>(matrix.rows());
      double beta[2] = {0, 0};
      for (std::size_t row = 0; row < size && common_.status == CHOLMOD_OK; row += rows_at_a_time) {
        is_stopped = pliant::is_stopped(should_stop);
        if (is_stopped) break;
        cholmod_rowfac(ordered, nullptr, beta, row, std::min(size, row + rows_at_a_time),
                       factor_.get(), &common_);
      }
    }
    cholmod_sparse* rest = ordered;
    cholmod_free_sparse(&rest, &common_);
    if (is_stopped) return interrupted();
    if (auto checked = check(matrix.rows()); !checked) return checked;
    // CHOLMOD factors an indefinite matrix as LDL^T without an error; D, the first entry of each
    // column of the factor, shows whether the matrix was definite. !(d > 0) is true for NaN too.
    const auto* starts = static_cast<const int*>(factor_->p);
    const auto* entries = static_cast<const double*>(factor_->x);
    for (int column = 0; column < matrix.rows(); ++column) {
      if (!(entries[starts[column]] > 0)) return fail(not_positive_definite(matrix.rows(), column));
    }
    return {};
  }

  Result<Field> solve(const Field& right_hand_sides) override {
    cholmod_dense view = {};
    view.nrow = view.d = static_cast<std::size_t>(right_hand_sides.rows());
    view.ncol = static_cast<std::size_t>(right_hand_sides.cols());
    view.nzmax = view.nrow * view.ncol;
    view.x = const_cast<double*>(right_hand_sides.data());  // NOLINT: CHOLMOD does not write to it
    view.xtype = CHOLMOD_REAL;
    view.dtype = CHOLMOD_DOUBLE;
    // solve2 reuses its solution and workspaces from call to call.
    cholmod_solve2(CHOLMOD_A, factor_.get(), &view, nullptr, &solution_, nullptr, &workspace_y_,
                   &workspace_e_, &common_);
    if (auto checked = check(right_hand_sides.rows()); !checked) return fail(checked.error());
    return Field(Eigen::Map<const Field>(static_cast<const double*>(solution_->x),
                                         right_hand_sides.rows(), 3));
  }

  // A solve only reads the factor.
  bool share(const SparseFactor& other) override {
    factor_ = static_cast<const CholmodFactor&>(other).factor_;
    return true;
  }

 private:
  // The matrix as CHOLMOD sees it, without a copy.
  static cholmod_sparse view_of(const SparseMatrix& matrix) {
    cholmod_sparse view = {};
    view.nrow = static_cast<std::size_t>(matrix.rows());
    view.ncol = static_cast<std::size_t>(matrix.cols());
    view.nzmax = static_cast<std::size_t>(matrix.nonZeros());
    view.p = const_cast<int*>(matrix.outerIndexPtr());  // NOLINT: CHOLMOD does not write to
    view.i = const_cast<int*>(matrix.innerIndexPtr());  // NOLINT: the matrix it analyses
    view.x = const_cast<double*>(matrix.valuePtr());    // NOLINT: or factors
    view.stype = 1;                                     // symmetric, the upper triangle is stored
    view.itype = CHOLMOD_INT;
    view.xtype = CHOLMOD_REAL;
    view.dtype = CHOLMOD_DOUBLE;
    view.sorted = 1;
    view.packed = 1;
    return view;
  }

  // The upper triangle of the matrix in the order of the factor; null: no memory.
  cholmod_sparse* in_order(const SparseMatrix& matrix) {
    cholmod_sparse view = view_of(matrix);
    auto* const order = static_cast<int*>(pattern_->Perm);
    cholmod_sparse* lower = cholmod_ptranspose(&view, 2, order, nullptr, 0, &common_);
    cholmod_sparse* const upper =
        lower ? cholmod_ptranspose(lower, 2, nullptr, nullptr, 0, &common_) : nullptr;
    cholmod_free_sparse(&lower, &common_);
    return upper;
  }

  Result<void> check(long size) const {
    if (common_.status == CHOLMOD_OK || common_.status == CHOLMOD_DSMALL) return {};
    if (common_.status == CHOLMOD_OUT_OF_MEMORY || common_.status == CHOLMOD_TOO_LARGE) {
      return fail(no_memory_for_factor(size));
    }
    return fail(not_positive_definite(size, factor_ ? static_cast<long>(factor_->minor) : 0));
  }

  cholmod_common common_ = {};
  cholmod_factor* pattern_ = nullptr;       // of the analysis
  std::shared_ptr<cholmod_factor> factor_;  // perhaps of several
  cholmod_dense* solution_ = nullptr;
  cholmod_dense* workspace_y_ = nullptr;
  cholmod_dense* workspace_e_ = nullptr;
};

}  // namespace

std::unique_ptr<SparseFactor> make_cholmod_factor() { return std::make_unique<CholmodFactor>(); }

}  // namespace pliant
