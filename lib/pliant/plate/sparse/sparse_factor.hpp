#pragma once

#include <cstddef>
#include <memory>

#include <Eigen/SparseCore>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/plate/solver_choice.hpp"

namespace pliant {

using SparseMatrix = Eigen::SparseMatrix<double>;

/// The factor L D L^T of a symmetric, positive definite matrix, of which the upper triangle is
/// given, in the order of AMD: the interface of what computes it. Internal to plate.
class SparseFactor {
 public:
  SparseFactor() = default;
  SparseFactor(const SparseFactor&) = delete;
  SparseFactor& operator=(const SparseFactor&) = delete;
  virtual ~SparseFactor() = default;

  /// Orders a matrix and finds the pattern of its factor.
  virtual Result<void> analyze(const SparseMatrix& matrix) = 0;

  /// The bytes that the factor takes, from the analysis on.
  virtual std::size_t bytes() const = 0;

  /// Those that making it takes for a while.
  virtual std::size_t work_bytes() const { return 0; }

  /// Factors a matrix with the pattern of the analysed one. Asks `should_stop` every now and then,
  /// but Eigen cannot. Errors: SolverFailed if it is not positive definite; Interrupted.
  virtual Result<void> factorize(const SparseMatrix& matrix, const StopRequest& should_stop) = 0;

  /// Solves for three right-hand sides (#rows x 3).
  virtual Result<Field> solve(const Field& right_hand_sides) = 0;

  /// Solves with the numbers of another factor, which the two share; this one need not be analyzed.
  /// Several may share the numbers of one at the same time, in several threads. False: nothing has
  /// changed, since this kind cannot do it. Requires: the other is of the same kind, and
  /// `factorize` succeeded.
  virtual bool share(const SparseFactor&) { return false; }
};

/// `SupernodalNumbers` of a real matrix.
std::unique_ptr<SparseFactor> make_supernodal_factor(const RunContext& context);
std::unique_ptr<SparseFactor> make_cholmod_factor();
std::unique_ptr<SparseFactor> make_eigen_factor();

/// One of these. Requires: it is available.
std::unique_ptr<SparseFactor> make_sparse_factor(SolverChoice choice,
                                                 const RunContext& context = {});

}  // namespace pliant
