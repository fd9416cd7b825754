#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "pliant/core/grid.hpp"
#include "pliant/plate/outline/outline.hpp"

namespace pliant {

/// A symmetric matrix on the nodes of a grid whose entries join nodes at most two steps apart: the
/// 13 nodes of the stencil, each pair once. `Real` is the type of its entries. Internal to plate.
template <class Real>
class StencilTable {
 public:
  struct Step {
    int di, dj;
  };

  /// The steps to the second node of a pair, which comes later, row by row.
  static constexpr std::array<Step, 7> steps = {
      {{0, 0}, {1, 0}, {2, 0}, {-1, 1}, {0, 1}, {1, 1}, {0, 2}}};

  explicit StencilTable(const Grid& grid)
      : grid_(grid), entries_(static_cast<std::size_t>(grid.node_count())) {}

  const Grid& grid() const { return grid_; }

  /// Adds to the entry of the nodes (i,j) + a and (i,j) + b, once for both of its places. Requires:
  /// both are in the grid, counted round.
  void add(int i, int j, Step a, Step b, Real value) {
    if (b.dj < a.dj || (b.dj == a.dj && b.di < a.di)) std::swap(a, b);
    entries_[grid_.node_round(i + a.di, j + a.dj)][place({b.di - a.di, b.dj - a.dj})] += value;
  }

  /// The entry of a node and the one `steps[k]` away.
  Real at(int node, std::size_t k) const { return entries_[static_cast<std::size_t>(node)][k]; }

  /// Calls f(node, other, entry) for all pairs in the grid, the entry being that of (node, other)
  /// and of (other, node).
  template <class F>
  void for_each(const F& f) const {
    const auto is_within = [](int line, int count, bool is_closed) {
      return is_closed || (line >= 0 && line < count);
    };
    int node = 0;
    for (int j = 0; j < grid_.rows; ++j) {
      for (int i = 0; i < grid_.columns; ++i, ++node) {
        for (std::size_t k = 0; k < steps.size(); ++k) {
          const auto [di, dj] = steps[k];
          if (!is_within(i + di, grid_.columns, grid_.is_closed_u) ||
              !is_within(j + dj, grid_.rows, grid_.is_closed_v)) {
            continue;
          }
          f(node, grid_.node_round(i + di, j + dj), at(node, k));
        }
      }
    }
  }

 private:
  static std::size_t place(Step step) {
    if (step.dj == 0) return static_cast<std::size_t>(step.di);
    return step.dj == 2 ? 6 : static_cast<std::size_t>(step.di + 4);
  }

  Grid grid_;
  std::vector<std::array<Real, 7>> entries_;
};

}  // namespace pliant
