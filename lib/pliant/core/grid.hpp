#pragma once

namespace pliant {

/// The rectangle of nodes i0..i1 x j0..j1 of a grid, both ends included.
struct Box {
  int i0 = 0;
  int i1 = -1;
  int j0 = 0;
  int j1 = -1;

  int columns() const { return i1 - i0 + 1; }
  int rows() const { return j1 - j0 + 1; }
  bool is_empty() const { return i1 < i0 || j1 < j0; }
  bool contains(int i, int j) const { return i0 <= i && i <= i1 && j0 <= j && j <= j1; }

  /// Grows to contain node (i,j) too.
  void include(int i, int j) {
    if (is_empty()) {
      *this = {i, i, j, j};
      return;
    }
    i0 = i < i0 ? i : i0;
    i1 = i > i1 ? i : i1;
    j0 = j < j0 ? j : j0;
    j1 = j > j1 ? j : j1;
  }

  /// Grows to contain `other` too.
  void include(const Box& other) {
    if (other.is_empty()) return;
    include(other.i0, other.j0);
    include(other.i1, other.j1);
  }

  friend bool operator==(const Box&, const Box&) = default;
};

/// The nodes in both boxes; empty if there are none.
inline Box intersection(const Box& a, const Box& b) {
  return {a.i0 > b.i0 ? a.i0 : b.i0, a.i1 < b.i1 ? a.i1 : b.i1, a.j0 > b.j0 ? a.j0 : b.j0,
          a.j1 < b.j1 ? a.j1 : b.j1};
}

/// Whether every node of `inner` is also in `outer`.
inline bool holds(const Box& outer, const Box& inner) {
  return intersection(outer, inner) == inner;
}

/// The closed directions of a grid: along them the first column (row) follows the last one.
enum class Wrap { None, U, V, UV };

inline bool closes_u(Wrap wrap) { return wrap == Wrap::U || wrap == Wrap::UV; }
inline bool closes_v(Wrap wrap) { return wrap == Wrap::V || wrap == Wrap::UV; }
inline Wrap wrap_of(bool closes_u, bool closes_v) {
  return closes_u && closes_v ? Wrap::UV : closes_u ? Wrap::U : closes_v ? Wrap::V : Wrap::None;
}

/// A uniform lattice over (u,v): node (i,j) is column i along u and row j along v. SPEC 1; thesis
/// 4.3, fig. 1, which has one spacing h instead of hu and hv.
///
/// Along a closed direction columns (rows) are counted round, and a box begins inside the grid and
/// may end beyond it: in a grid of 10 columns, those of 8 to 11 are 8, 9, 0 and 1. A box of all
/// columns begins at column 0 and has no first or last one; it is a *ring*.
struct Grid {
  int columns = 0;  ///< M, nodes along u
  int rows = 0;     ///< N, nodes along v
  double hu = 0;    ///< spacing along u [uv]
  double hv = 0;    ///< spacing along v [uv]

  bool is_closed_u = false;  ///< column 0 follows column M - 1
  bool is_closed_v = false;  ///< row 0 follows row N - 1

  bool is_open() const { return !is_closed_u && !is_closed_v; }
  int node_count() const { return columns * rows; }
  int node(int i, int j) const { return j * columns + i; }
  Box box() const { return {0, columns - 1, 0, rows - 1}; }

  /// Node (i,j) counted round. Requires: along closed directions less than a lap beyond the grid,
  /// along others inside.
  int node_round(int i, int j) const {
    if (is_closed_u) i += i < 0 ? columns : i >= columns ? -columns : 0;
    if (is_closed_v) j += j < 0 ? rows : j >= rows ? -rows : 0;
    return node(i, j);
  }

  /// Whether a box of this grid is a ring along u (v).
  bool is_ring_u(const Box& box) const { return is_closed_u && box.columns() == columns; }
  bool is_ring_v(const Box& box) const { return is_closed_v && box.rows() == rows; }

  friend bool operator==(const Grid&, const Grid&) = default;
};

}  // namespace pliant
