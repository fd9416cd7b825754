#pragma once

#include <optional>

#include <cholmod.h>

#include "pliant/plate/plate_solver.hpp"
#include "support/plates.hpp"

namespace pliant::bench {

/// CHOLMOD's supernodal Cholesky with the system's BLAS, for comparison only: its bits depend on
/// the BLAS, and its licence is the GPL. Errors end in `is_good`.
class SupernodalCholmod {
 public:
  /// METIS needs half of AMD's fill on a grid, and more time.
  explicit SupernodalCholmod(int ordering) {
    cholmod_start(&common_);
    common_.supernodal = CHOLMOD_SUPERNODAL;
    common_.nmethods = 1;
    common_.method[0].ordering = ordering;
  }
  SupernodalCholmod(const SupernodalCholmod&) = delete;
  SupernodalCholmod& operator=(const SupernodalCholmod&) = delete;
  ~SupernodalCholmod() {
    cholmod_free_factor(&factor_, &common_);
    for (cholmod_dense* dense : {solution_, workspace_y_, workspace_e_})
      cholmod_free_dense(&dense, &common_);
    cholmod_finish(&common_);
  }

  /// Orders the first matrix; the others have its pattern.
  void factor(const SparseMatrix& matrix) {
    cholmod_sparse view = {};
    view.nrow = view.ncol = static_cast<std::size_t>(matrix.rows());
    view.nzmax = static_cast<std::size_t>(matrix.nonZeros());
    view.p = const_cast<int*>(matrix.outerIndexPtr());
    view.i = const_cast<int*>(matrix.innerIndexPtr());
    view.x = const_cast<double*>(matrix.valuePtr());
    view.stype = 1;
    view.itype = CHOLMOD_INT;
    view.xtype = CHOLMOD_REAL;
    view.sorted = view.packed = 1;
    if (!factor_) factor_ = cholmod_analyze(&view, &common_);
    cholmod_factorize(&view, factor_, &common_);
  }

  Field solve(const Field& right_hand_sides) {
    cholmod_dense view = {};
    view.nrow = view.d = static_cast<std::size_t>(right_hand_sides.rows());
    view.ncol = 3;
    view.nzmax = 3 * view.nrow;
    view.x = const_cast<double*>(right_hand_sides.data());
    view.xtype = CHOLMOD_REAL;
    cholmod_solve2(CHOLMOD_A, factor_, &view, nullptr, &solution_, nullptr, &workspace_y_,
                   &workspace_e_, &common_);
    return Field(Eigen::Map<const Field>(static_cast<const double*>(solution_->x),
                                         right_hand_sides.rows(), 3));
  }

  bool is_good() const { return common_.status == CHOLMOD_OK; }
  std::size_t memory() const { return common_.memory_inuse; }

 private:
  cholmod_common common_ = {};
  cholmod_factor* factor_ = nullptr;
  cholmod_dense* solution_ = nullptr;
  cholmod_dense* workspace_y_ = nullptr;
  cholmod_dense* workspace_e_ = nullptr;
};

/// The same as a solver of plates.
class SupernodalSolver final : public PlateSolver {
 public:
  SupernodalSolver() : PlateSolver({}) {}

  Result<void> prepare(const PlateSystem& system) override {
    if (factored_ == system) return {};
    factor_.factor(testing::assemble_upper(system));
    if (!factor_.is_good()) return fail(ErrorCode::SolverFailed, "supernodal");
    factored_ = system;
    return {};
  }

  Result<Field> solve(const Field& right_hand_sides) override {
    return factor_.solve(right_hand_sides);
  }

  SolverCounts counts() const override { return {}; }
  std::size_t memory() const override { return factor_.memory(); }

 private:
  std::optional<PlateSystem> factored_;
  SupernodalCholmod factor_{CHOLMOD_METIS};
};

}  // namespace pliant::bench
