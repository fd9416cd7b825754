#pragma once

#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/plate/exact/pade.hpp"
#include "pliant/plate/kernels/kernels.hpp"
#include "pliant/plate/number_block.hpp"
#include "pliant/plate/sparse/supernode_pattern.hpp"

namespace pliant {

// Factors by supernodes, from the leaves of their tree to its root: each gathers what those below
// it leave for its rows in one dense matrix, its front, eliminates its columns, and leaves the rest
// to its parent. The same bits for every width of vectors and number of threads. Internal to plate.
// Source: Liu, "The multifrontal method for sparse matrix solution: theory and practice" (1992).

/// The factor L D L^T of K + S, for real numbers or, with `Complex`, for a complex S and a positive
/// semidefinite K. No pivots are exchanged: none is needed if K + S is positive definite, or if the
/// numbers of S all lie within an angle of less than 180 degrees that has the positive numbers in
/// it or at its side. Source: A. George, Kh. D. Ikramov, A. B. Kucherov, "On the growth factor in
/// Gaussian elimination for generalized Higham matrices", 2002.
template <class Number>
class SupernodalNumbers {
 public:
  /// Doubles of a row that is solved: the three right-hand sides, and one that pads them; of
  /// complex ones first their real parts.
  static constexpr int line = row_numbers * (std::is_same_v<Number, double> ? 1 : 2);

  /// Of one factor with its pattern's numbers, and what making it takes for a while. [bytes]
  static std::size_t bytes(const SupernodePattern& pattern);
  static std::size_t work_bytes(const SupernodePattern& pattern);

  /// K's upper triangle has the pattern and these values; `shifts` is S, of its first rows. Asks
  /// `context` whether to stop. Errors: SolverFailed if a pivot is not positive, complex: 0, or not
  /// finite; Interrupted.
  Result<void> factorize(std::shared_ptr<const SupernodePattern> pattern, const double* values,
                         std::span<const Number> shifts, const RunContext& context);

  /// Solves in place: rows in the order of the pattern (#solve_size x `line`), of a `NumberBlock`.
  void solve(const RunContext& context, double* x) const;

  const SupernodePattern& pattern() const { return *pattern_; }

 private:
  std::shared_ptr<const SupernodePattern> pattern_;
  NumberBlock entries_;  // of L, see `SupernodesView`
  std::vector<Number> pivots_;
};

extern template class SupernodalNumbers<double>;
extern template class SupernodalNumbers<Complex>;

}  // namespace pliant
