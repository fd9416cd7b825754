#pragma once

#include <cstddef>
#include <optional>

#include "pliant/core/run_context.hpp"
#include "pliant/plate/sparse/factored_matrix.hpp"
#include "pliant/plate/sparse/plate_matrix.hpp"

namespace pliant {

/// A factor whose solutions are corrected if rounding makes them wrong by more than 1e-10 of their
/// peak, or if that is asked for. Internal to plate.
class RefinedFactor {
 public:
  /// `matrix` outlives the factor.
  RefinedFactor(PlateMatrix& matrix, SolverChoice choice, const RunContext& context);

  /// Factors the matrix with these shifts of its first rows. `has_same_pattern`: as
  /// `FactoredMatrix::factor`. `pressure` (#shifts): right-hand side of these rows by which the
  /// first solve measures the error; the peak of a solution is theirs. `corrects`: solutions are
  /// corrected in any case. Errors: those of `FactoredMatrix`.
  Result<void> factor(const Eigen::VectorXd& shifts, bool has_same_pattern,
                      const Eigen::VectorXd& pressure, bool corrects);

  /// Solves for three right-hand sides (#rows x 3). A good guess saves work if solutions are
  /// corrected. Requires: `factor` succeeded last. Errors: those of the matrix's `open` too.
  Result<Field> solve(const Field& right_hand_sides, std::optional<Field> guess = {});

  /// The same, never corrected.
  Result<Field> solve_roughly(const Field& right_hand_sides);

  /// Solves for the steps of an interval, one after another: guesses from the last two.
  void begin_steps() { last_ = before_ = std::nullopt; }
  Result<Field> solve_next(const Field& right_hand_sides);

  /// Whether solutions are corrected.
  bool refines() const { return refines_; }

  SolverCounts counts() const { return factor_.counts(); }
  std::size_t memory() const { return factor_.memory(); }

 private:
  double peak(const Field& solution) const {
    return solution.topRows(shifts_.size()).cwiseAbs().maxCoeff();
  }
  Result<void> measure();

  PlateMatrix& matrix_;
  StopRequest should_stop_;
  FactoredMatrix factor_;
  Eigen::VectorXd shifts_, pressure_;
  bool corrects_ = false, is_measured_ = false, refines_ = false;
  double error_ = 0;                    // of a solution, as a part of its peak, if it is corrected
  std::optional<Field> last_, before_;  // the solutions of the last two steps, if corrected
};

}  // namespace pliant
