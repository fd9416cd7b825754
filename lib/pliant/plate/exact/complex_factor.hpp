#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/plate/exact/pade.hpp"
#include "pliant/plate/sparse/sparse_factor.hpp"

namespace pliant {

/// The pattern of the factor L D L^T of a symmetric matrix, in the order of AMD; factors of
/// matrices with one pattern share it. Internal to plate. Source: T. A. Davis, Algorithm 849 (LDL),
/// 2005.
class FactorPattern {
 public:
  FactorPattern() = default;

  /// Of a matrix of which the upper triangle is given. Counts the entries only.
  explicit FactorPattern(const SparseMatrix& upper);

  /// Finds the entries. Takes all of `memory`.
  void store_entries();

  int size() const { return static_cast<int>(order_.size()); }
  std::size_t entries() const { return starts_.empty() ? 0 : starts_.back(); }  ///< of L - I
  std::size_t memory() const;                                                   ///< [bytes]

 private:
  friend class ComplexFactor;

  std::vector<int> order_;           // the matrix's row for each of the factor's
  std::vector<int> parents_;         // of the elimination tree, -1 at a root
  std::vector<std::size_t> starts_;  // of the columns of L
  std::vector<int> rows_;            // of L, ascending in each column
  std::vector<int> own_starts_, own_rows_, own_places_;  // of the matrix, upper triangle by columns
};

/// The factor of K + S for a real symmetric positive semidefinite K and a complex diagonal S. No
/// pivots are exchanged: none is needed if the numbers of S all lie within an angle of less than
/// 180 degrees that has the positive numbers in it or at its side. Internal to plate. Source: A.
/// George, Kh. D. Ikramov, A. B. Kucherov, "On the growth factor in Gaussian elimination for
/// generalized Higham matrices", 2002.
class ComplexFactor {
 public:
  static std::size_t memory(const FactorPattern& pattern);  ///< of one factor [bytes]

  /// `upper` is the matrix of `pattern` or one with its places; `shifts` (#first rows) is added to
  /// its diagonal. Errors: SolverFailed if a pivot is 0 or not finite; Interrupted.
  Result<void> factorize(const FactorPattern& pattern, const SparseMatrix& upper,
                         std::span<const Complex> shifts, const StopRequest& should_stop);

  /// Numbers of a row: three right-hand sides, and one that pads them; real and imaginary parts.
  static constexpr int row_numbers = 8;

  /// Solves for right-hand sides in the order of the pattern (#rows x `row_numbers`), in place.
  void solve(const FactorPattern& pattern, double* x) const;

  static int row_of(const FactorPattern& pattern, int place) { return pattern.order_[place]; }

 private:
  std::vector<Complex> entries_;  // of L
  std::vector<Complex> pivots_;   // 1/D
};

}  // namespace pliant
