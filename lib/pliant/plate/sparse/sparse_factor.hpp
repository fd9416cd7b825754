#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include <Eigen/SparseCore>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/plate/solver_choice.hpp"

namespace pliant {

using SparseMatrix = Eigen::SparseMatrix<double>;

/// The columns of a factor L D L^T, in its library's memory.
struct FactorColumns {
  int size = 0;
  const int* order = nullptr;       ///< row of the matrix for each row of L
  const int* starts = nullptr;      ///< of each column in `rows` and `entries`
  const int* counts = nullptr;      ///< entries of each column
  const int* rows = nullptr;        ///< of the entries, ascending; a column's first is its own
  const double* entries = nullptr;  ///< a column's first is its pivot in D, the others are L's
};

/// The factor L D L^T of a symmetric, positive definite matrix, of which the upper triangle is
/// given, in the order of AMD: the interface of the libraries that compute it. Internal to plate.
class SparseFactor {
 public:
  SparseFactor() = default;
  SparseFactor(const SparseFactor&) = delete;
  SparseFactor& operator=(const SparseFactor&) = delete;
  virtual ~SparseFactor() = default;

  /// Orders a matrix and finds the pattern of its factor.
  virtual Result<void> analyze(const SparseMatrix& matrix) = 0;

  /// Entries that the factor has room for: those that the analysis finds, before and after it is
  /// made.
  virtual std::size_t entries() const = 0;

  /// Factors a matrix with the pattern of the analysed one. CHOLMOD asks `should_stop` every now
  /// and then, Eigen cannot. Errors: SolverFailed if it is not positive definite; Interrupted.
  virtual Result<void> factorize(const SparseMatrix& matrix, const StopRequest& should_stop) = 0;

  /// Solves for three right-hand sides (#rows x 3).
  virtual Result<Field> solve(const Field& right_hand_sides) = 0;

  /// Valid until the next call that is not const; nullopt if the library does not show them.
  virtual std::optional<FactorColumns> columns() const { return std::nullopt; }

  /// Frees the numbers: what follows is `factorize`.
  virtual void release() {}

  /// Solves with the numbers of another factor, which the two share; this one need not be analyzed.
  /// Several may share the numbers of one at the same time, in several threads. False: nothing has
  /// changed, since the library cannot do this. Requires: the other is of the same library, and
  /// `factorize` succeeded.
  virtual bool share(const SparseFactor&) { return false; }
};

std::unique_ptr<SparseFactor> make_cholmod_factor();
std::unique_ptr<SparseFactor> make_eigen_factor();

/// One of the two above. Requires: it is available.
std::unique_ptr<SparseFactor> make_sparse_factor(SolverChoice choice);

}  // namespace pliant
