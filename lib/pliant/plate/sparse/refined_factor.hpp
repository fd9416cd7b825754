#pragma once

#include <cstddef>
#include <optional>

#include "pliant/core/run_context.hpp"
#include "pliant/plate/sparse/factored_matrix.hpp"

namespace pliant {

/// A symmetric matrix of which what a solution leaves can be computed in extended precision (64
/// bits of mantissa on x86-64). Internal to plate.
class PreciseMatrix {
 public:
  PreciseMatrix() = default;
  PreciseMatrix(const PreciseMatrix&) = delete;
  PreciseMatrix& operator=(const PreciseMatrix&) = delete;
  virtual ~PreciseMatrix() = default;

  /// The upper triangle, by columns, rows ascending. Errors: Interrupted.
  virtual Result<SparseMatrix> upper() const = 0;

  /// Makes what `residual` needs, for a matrix with so many entries in `upper`. Errors:
  /// OutOfMemory; Interrupted.
  virtual Result<void> open(std::size_t entries) = 0;

  /// f - A x (#rows x 3). Requires: `open` succeeded.
  virtual Field residual(const Field& x, const Field& f) const = 0;

  /// Frees what `open` made.
  virtual void close() = 0;
};

/// A factor whose solutions are corrected if rounding makes them wrong by more than
/// 1e-10 of their peak. Internal to plate.
class RefinedFactor {
 public:
  /// `matrix` outlives the factor.
  RefinedFactor(PreciseMatrix& matrix, SolverChoice choice, const RunContext& context);

  /// Factors the matrix as it is now, of `size` rows. `pressure` (at most `size` entries): right-
  /// hand side of the first rows by which the error is measured; the peak of a solution is theirs.
  /// Errors: those of `FactoredMatrix::factor`.
  Result<void> factor(long size, bool has_same_pattern, const Eigen::VectorXd& pressure);

  /// Solves for three right-hand sides (#rows x 3). A good guess saves work if solutions are
  /// corrected. Requires: `factor` succeeded last.
  Result<Field> solve(const Field& right_hand_sides, std::optional<Field> guess = {});

  /// Solves for the steps of an interval, one after another: guesses from the last two.
  void begin_steps() { last_ = before_ = std::nullopt; }
  Result<Field> solve_next(const Field& right_hand_sides);

  /// Whether solutions are corrected.
  bool refines() const { return error_ > 0; }

  SolverCounts counts() const { return factor_.counts(); }
  std::size_t memory() const { return factor_.memory(); }

 private:
  double peak(const Field& solution) const { return solution.topRows(rows_).cwiseAbs().maxCoeff(); }
  Result<void> measure(const SparseMatrix& upper, const Eigen::VectorXd& pressure);

  PreciseMatrix& matrix_;
  StopRequest should_stop_;
  FactoredMatrix factor_;
  Eigen::Index rows_ = 0;               // of which a solution's peak is taken
  double error_ = 0;                    // of a solution, as a part of its peak; 0: small enough
  std::optional<Field> last_, before_;  // the solutions of the last two steps, if corrected
};

}  // namespace pliant
