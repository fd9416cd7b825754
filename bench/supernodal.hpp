#pragma once

#include <optional>

#include <cholmod.h>

#include "pliant/plate/plate_solver.hpp"
#include "pliant/plate/sparse/operator.hpp"

namespace pliant::bench {

/// CHOLMOD's supernodal Cholesky with the system's BLAS, for comparison only: its bits depend on
/// the BLAS, and its licence is the GPL.
class SupernodalSolver final : public PlateSolver {
 public:
  SupernodalSolver() : PlateSolver({}) {
    cholmod_start(&common_);
    common_.supernodal = CHOLMOD_SUPERNODAL;
    common_.nmethods = 1;
    common_.method[0].ordering = CHOLMOD_METIS;  // half of AMD's fill on a grid
  }
  ~SupernodalSolver() override {
    cholmod_free_factor(&factor_, &common_);
    for (cholmod_dense* dense : {solution_, workspace_y_, workspace_e_}) {
      cholmod_free_dense(&dense, &common_);
    }
    cholmod_finish(&common_);
  }

  Result<void> prepare(const PlateSystem& system) override {
    if (factored_ == system) return {};
    const SparseMatrix matrix = assemble_upper(system);
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
    if (common_.status != CHOLMOD_OK) return fail(ErrorCode::SolverFailed, "supernodal");
    factored_ = system;
    return {};
  }

  Result<Field> solve(const Field& right_hand_sides) override {
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

  SolverCounts counts() const override { return {}; }
  std::size_t memory() const override { return common_.memory_inuse; }

 private:
  std::optional<PlateSystem> factored_;
  cholmod_common common_ = {};
  cholmod_factor* factor_ = nullptr;
  cholmod_dense* solution_ = nullptr;
  cholmod_dense* workspace_y_ = nullptr;
  cholmod_dense* workspace_e_ = nullptr;
};

}  // namespace pliant::bench
