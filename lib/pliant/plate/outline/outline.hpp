#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pliant/core/edges.hpp"
#include "pliant/core/field.hpp"
#include "pliant/core/grid.hpp"

namespace pliant {

/// 1 for each interior node of a grid and 0 for the others (#nodes, row = grid.node(i, j)).
using InteriorMask = std::vector<std::uint8_t>;

/// The shape of a patch: which nodes of a grid are interior. The others are its rim, or belong to
/// no patch. Unknowns are the interior nodes, numbered row by row. In each row they form runs: in a
/// rectangle, one from the second node to the last but one; in any other outline, those of a mask.
/// SPEC 5; docs/model.md, eq. (12) to (14).
///
/// A grid that is closed along u (v) makes its outline periodic: node (i,j) is counted round, and
/// there is no rim at those ends. docs/model.md, eq. (49). Neither is there at a free edge, whose
/// nodes are interior, but for those that are on another edge too.
///
/// Everything that depends on the shape asks the outline: which nodes are unknowns, and which are
/// next to the rim.
class Outline {
 public:
  /// Neighbouring interior nodes, (i0,j) to (i1,j), with no interior node before or after them in
  /// the row, which is not counted round.
  struct Run {
    int j, i0, i1;

    int count() const { return i1 - i0 + 1; }
  };

  Outline() = default;

  /// All nodes but the outermost are interior: a rectangle, or a ring of a closed grid. Not
  /// explicit, since most plates are rectangles.
  Outline(const Grid& grid);  // NOLINT

  /// The same, with other edges. Along closed directions they do not matter.
  Outline(const Grid& grid, const Edges& edges);

  /// Any other outline; an empty mask is the one above again. Requires: interior nodes have all
  /// eight neighbours in the grid. If two nodes that are two steps apart along u or v are interior,
  /// so is the one between them, as for every outline that follows cells.
  Outline(const Grid& grid, InteriorMask mask);

  /// A rectangle, or a ring, of which some nodes are held with their slopes free: a plate of the
  /// bending energy. `mask` has the others, as far as the edges leave them unknown.
  Outline(const Grid& grid, const Edges& edges, InteriorMask mask);

  const Grid& grid() const { return grid_; }
  const Edges& edges() const { return edges_; }

  /// Whether it is a rectangle with a rim all around.
  bool is_rectangle() const { return is_rectangle_; }
  bool is_periodic() const { return !grid_.is_open(); }
  const InteriorMask& mask() const { return mask_; }  ///< empty for a rectangle or a ring
  int unknown_count() const { return unknowns_; }
  bool has_held_nodes() const { return has_held_nodes_; }  ///< those that the mask lacks

  /// Whether no node is rim, so that a static plate has no solution.
  bool is_unheld() const { return unknowns_ == grid_.node_count(); }

  /// Whether node (i,j) is interior. Requires: it is a node of the grid, counted round.
  bool holds(int i, int j) const {
    if (is_periodic()) return holds_round(i, j);
    if (mask_.empty()) return inner_.contains(i, j);
    return mask_[static_cast<std::size_t>(grid_.node(i, j))] != 0;
  }

  /// Calls f(run) for all runs, row by row.
  template <class F>
  void for_each_run(const F& f) const {
    for (int j = inner_.j0; j <= inner_.j1; ++j) {
      if (mask_.empty()) {
        if (!inner_.is_empty()) f(Run{j, inner_.i0, inner_.i1});
        continue;
      }
      const auto row = mask_.begin() + grid_.node(0, j), end = row + grid_.columns;
      for (auto first = row, last = row; first != end; first = last) {
        first = std::find(first, end, std::uint8_t{1});
        last = std::find(first, end, std::uint8_t{0});
        if (first == end) break;
        f(Run{j, static_cast<int>(first - row), static_cast<int>(last - row) - 1});
      }
    }
  }

  /// Calls f(i, j) for the interior nodes beside which the stencil may reach the rim; the values
  /// around all others are those of interior nodes. Row by row.
  template <class F>
  void for_each_near_rim(const F& f) const {
    for_each_run([&](const Run& run) {
      const auto& [j, i0, i1] = run;
      const bool is_deep = run.count() > 4 && holds_all({j - 1, i0 + 1, i1 - 1}) &&
                           holds_all({j + 1, i0 + 1, i1 - 1}) &&
                           holds_all({j - 2, i0 + 2, i1 - 2}) && holds_all({j + 2, i0 + 2, i1 - 2});
      for (int i = i0; i <= i1; ++i) {
        if (is_deep && i == i0 + 2) i = i1 - 1;  // only the two nodes at each end
        f(i, j);
      }
    });
  }

  friend bool operator==(const Outline&, const Outline&) = default;

 private:
  bool holds_all(const Run& nodes) const;
  bool holds_round(int i, int j) const;

  Grid grid_;
  Edges edges_;
  Box inner_;          // the interior nodes, or those of the mask and maybe others
  InteriorMask mask_;  // empty: all but the outermost nodes
  int unknowns_ = 0;
  bool is_rectangle_ = true;
  bool has_held_nodes_ = false;
};

inline int unknown_count(const Outline& outline) { return outline.unknown_count(); }

/// The way from a node of an open grid to another, in nodes: the same everywhere.
struct OpenSteps {
  int columns;

  int to(int di, int dj) const { return di + dj * columns; }
};

/// The way from a node of a closed grid to those near it, in nodes, counted round.
class RoundSteps {
 public:
  RoundSteps(const Grid& grid, int i, int j) {
    for (int step = -2; step <= 2; ++step) {
      u_[step + 2] = (grid.is_closed_u ? (i + step + grid.columns) % grid.columns : i + step) - i;
      v_[step + 2] = (grid.is_closed_v ? (j + step + grid.rows) % grid.rows : j + step) - j;
      v_[step + 2] *= grid.columns;
    }
  }

  /// To the node `di` columns and `dj` rows away, at most two each.
  int to(int di, int dj) const { return u_[di + 2] + v_[dj + 2]; }

 private:
  int u_[5], v_[5];
};

/// Calls f(steps_at), where steps_at(i, j) are the steps from node (i,j). Compiles f for open grids
/// by itself, so that these do not pay for the others.
template <class F>
void with_steps(const Outline& outline, const F& f) {
  const Grid& grid = outline.grid();
  if (outline.is_periodic()) {
    f([&](int i, int j) { return RoundSteps(grid, i, j); });
  } else {
    f([&](int, int) { return OpenSteps{grid.columns}; });
  }
}

/// The number of each interior node among the unknowns, -1 for the others (#nodes).
std::vector<int> numbers_of_unknowns(const Outline& outline);

/// Whether two outlines differ in their spacings at most, so that their matrices have one pattern.
bool have_same_nodes(const Outline& a, const Outline& b);

/// The interior rows of a field on all nodes (#nodes x 3 -> #unknowns x 3).
Field interior_of(const Outline& outline, const Field& nodes);

/// Writes interior rows back: `nodes` with its interior replaced, all other rows unchanged.
Field with_interior(const Outline& outline, Field nodes, const Field& unknowns);

/// Sets the rows of all nodes that are not interior to 0.
void clear_rim(const Outline& outline, Field& nodes);

}  // namespace pliant
