#pragma once

#include <vector>

#include "pliant/core/triangle_cells.hpp"
#include "pliant/plate/triangles/cell_factors.hpp"
#include "pliant/plate/triangles/morley_cell.hpp"

namespace pliant {

/// Unknowns of a plate of triangles: the free points, then the slopes. Some are inner: they have no
/// mass, and belong to one block of cells only. The others are numbered again.
struct ReducedUnknowns {
  std::vector<int> places;  ///< of each unknown among those that are not inner; -1: inner
  int count = 0;
  std::vector<int> blocks;  ///< those with inner unknowns, ascending
  std::size_t pairs = 0;    ///< of unknowns that are left, themselves too, over all blocks

  /// Requires: the first `mass_count` points have a mass; they keep their numbers.
  ReducedUnknowns(const TriangleCells& cells, int mass_count);
};

/// The matrix of one block, with the inner unknowns eliminated; reused from block to block. `Real`
/// is the type of its sums. Internal to plate.
template <class Real>
class CellBlock {
 public:
  /// Computes the block's matrix, and eliminates. A pivot of 0 makes numbers that are not finite.
  /// `factors` null: the material is even.
  void compute(const TriangleCells& cells, int block, const ReducedUnknowns& reduced,
               const Bending& bending, const CellFactors* factors = nullptr);

  int size() const { return static_cast<int>(unknowns_.size()); }
  int inner_count() const { return inner_count_; }

  /// Unknown k of the plate; the inner ones come first.
  int unknown(int k) const { return unknowns_[static_cast<std::size_t>(k)]; }

  /// Between two unknowns that are not inner.
  Real at(int row, int column) const { return matrix_[index(row, column)]; }

  /// Eliminates the inner unknowns from forces on the block's unknowns (#size).
  void reduce(std::vector<Real>& forces) const {
    for (int p = 0; p < inner_count_; ++p) {
      for (int k = p + 1; k < size(); ++k) forces[k] -= at(p, k) / at(p, p) * forces[p];
    }
  }

 private:
  std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * unknowns_.size() + static_cast<std::size_t>(column);
  }

  std::vector<int> unknowns_;
  int inner_count_ = 0;
  std::vector<Real> matrix_;  // the upper triangle, row by row
};

}  // namespace pliant
