#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "pliant/core/grid.hpp"

namespace pliant {

// Boxes of a grid that may be closed: where they meet, and what holds them. Of an open grid every
// answer is that of `intersection` and `Box::include`, at the same cost. Internal to region and to
// the rooms that use it.

/// The same nodes as a box that may begin before the grid or after its end, in the form that `Grid`
/// states; a ring if it is a lap or longer.
Box placed(const Grid& grid, Box box);

/// The smallest box around all nodes of the boxes. Along a closed direction: the shortest run of
/// columns (rows) that holds theirs; of several, the one that begins first.
Box box_around(const Grid& grid, std::span<const Box> boxes);

/// Whether every node of `inner` is also in `outer`.
bool holds(const Grid& grid, const Box& outer, const Box& inner);

/// Calls f(box) with the nodes of `a` that are also in `b`, in the columns and
/// rows of `a`: never, once or, if they meet on both sides of a closed grid, several times.
template <class F>
void for_each_shared(const Grid& grid, const Box& a, const Box& b, const F& f) {
  const auto visit = [&](const Box& moved) {
    if (const Box shared = intersection(a, moved); !shared.is_empty()) f(shared);
  };
  if (grid.is_open()) {
    visit(b);
    return;
  }
  if (b.is_empty()) return;
  const int laps_u = grid.is_closed_u ? 1 : 0, laps_v = grid.is_closed_v ? 1 : 0;
  for (int v = -laps_v; v <= laps_v; ++v) {
    for (int u = -laps_u; u <= laps_u; ++u) {
      visit({b.i0 + u * grid.columns, b.i1 + u * grid.columns, b.j0 + v * grid.rows,
             b.j1 + v * grid.rows});
    }
  }
}

/// Whether two boxes share a node.
inline bool meet(const Grid& grid, const Box& a, const Box& b) {
  bool is_met = false;
  for_each_shared(grid, a, b, [&](const Box&) { is_met = true; });
  return is_met;
}

/// Calls f(node, offset, count) for the nodes of columns i0 to i1 in row j, in stretches that are
/// contiguous in memory: `node` is the first of a stretch, `offset` its distance from i0.
template <class F>
void for_each_stretch(const Grid& grid, int i0, int i1, int j, const F& f) {
  for (int i = i0; i <= i1;) {
    const int end = i < grid.columns ? std::min(i1 + 1, grid.columns) : i1 + 1;
    f(grid.node_round(i, j), i - i0, end - i);
    i = end;
  }
}

/// The columns and the rows of some nodes of a closed grid.
class LineMarks {
 public:
  explicit LineMarks(const Grid& grid);

  void include(int i, int j) {
    columns_[static_cast<std::size_t>(i)] = 1;
    rows_[static_cast<std::size_t>(j)] = 1;
  }

  /// Requires: it is a box of the grid.
  void include(const Box& box);

  /// Whether all columns and rows of a box are marked. Requires: it does not cross a seam.
  bool holds(const Box& box) const;

  /// The smallest box that holds them all.
  Box box() const;

 private:
  Grid grid_;
  std::vector<std::uint8_t> columns_, rows_;
};

}  // namespace pliant
