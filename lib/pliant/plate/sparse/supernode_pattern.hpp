#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pliant/plate/kernels/kernels.hpp"
#include "pliant/plate/sparse/sparse_factor.hpp"

namespace pliant {

/// The pattern of the factor L D L^T of a symmetric matrix, its columns in supernodes: neighbouring
/// columns that share the rows below them. Some of its entries are 0, where a few zeros make large
/// supernodes of small ones. Depends on the matrix's pattern only. Internal to plate. Sources:
/// Davis, Rajamanickam, Sid-Lakhdar, "A survey of direct methods for sparse linear systems" (2016);
/// Gilbert, Ng, Peyton, "An efficient algorithm to compute row and column counts for sparse
/// Cholesky factorization" (1994); Ashcraft, Grimes, "The influence of relaxed supernode partitions
/// on the multifrontal method" (1989).
class SupernodePattern {
 public:
  /// An entry of the matrix, in the lower triangle of the factor's order.
  struct OwnEntry {
    int row = 0;
    int place = 0;  ///< among the values of the matrix
  };

  SupernodePattern() = default;

  /// Of a matrix of which the upper triangle is given, in the order of AMD.
  explicit SupernodePattern(const SparseMatrix& upper);

  int size() const { return static_cast<int>(order_.size()); }

  /// The matrix's row for each row of L.
  const std::vector<int>& order() const { return order_; }

  /// In the order of their columns, each after those that it takes an update from.
  const std::vector<Supernode>& supernodes() const { return supernodes_; }

  /// The supernode of the first row below each; -1: none.
  const std::vector<int>& parents() const { return parents_; }

  /// Those of which a supernode is the parent, from the last to the first.
  template <class F>
  void for_each_child(int supernode, const F& f) const {
    for (int child = last_children_[supernode]; child >= 0; child = previous_siblings_[child])
      f(child);
  }

  /// Supernodes below one of them, and that itself.
  struct Subtree {
    int first = 0, root = 0;
    int foreign_rows_at = 0;  ///< behind those of L, see `solve_rows`
  };

  /// Subtrees of about the same work, apart from each other, for threads; none of a small matrix.
  const std::vector<Subtree>& subtrees() const { return subtrees_; }
  const std::vector<int>& above_subtrees() const { return above_; }  ///< ascending

  /// As `rows`, but subtrees share none: rows of L that are not a subtree's own are for it the ones
  /// from `foreign_rows_at` on, in the order of those below its root.
  const std::vector<int>& solve_rows() const { return subtrees_.empty() ? rows_ : solve_rows_; }
  int solve_size() const { return solve_size_; }  ///< rows of L and those behind them

  const std::vector<int>& rows() const { return rows_; }  ///< below each supernode, ascending
  std::span<const int> rows_below(const Supernode& node) const {
    return std::span(rows_).subspan(static_cast<std::size_t>(node.rows_at),
                                    static_cast<std::size_t>(node.rows));
  }

  /// The matrix's entries in a column of L.
  std::span<const OwnEntry> own_entries(int column) const {
    return std::span(own_entries_)
        .subspan(own_starts_[column], own_starts_[column + 1] - own_starts_[column]);
  }

  long entry_count() const { return entry_count_; }  ///< without D

  std::size_t memory() const;  ///< [bytes]

 private:
  void find_own_entries(const SparseMatrix& upper);
  std::vector<int> counts(const std::vector<int>& parents) const;
  void join_columns(const std::vector<int>& parents, const std::vector<int>& counts);
  void divide_supernodes();
  void find_rows();
  void find_subtrees();

  std::vector<int> order_;
  std::vector<int> own_starts_;  // of each column in `own_entries_`
  std::vector<OwnEntry> own_entries_;
  std::vector<Supernode> supernodes_;
  std::vector<int> parents_, last_children_, previous_siblings_;
  std::vector<int> rows_, solve_rows_;
  std::vector<Subtree> subtrees_;
  std::vector<int> above_;
  int solve_size_ = 0;
  long entry_count_ = 0;
};

/// Numbers of a strict lower triangle of so many rows.
constexpr long triangle(long rows) { return rows * (rows - 1) / 2; }

}  // namespace pliant
