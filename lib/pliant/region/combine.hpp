#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pliant/core/grid.hpp"

namespace pliant {

/// How the boxes of several forces become one region or several. SPEC 5.
enum class Combine {
  Box,      ///< one box around everything: the thesis
  Islands,  ///< boxes that share a node merge into their common box; each is solved separately
  Union,    ///< the cells of all boxes together are one region, of any outline
};

/// Interior nodes of a region that form one system of equations: those of a rectangle, or a set
/// that is connected, diagonally too.
struct Patch {
  Box box;  ///< interior nodes and the rim around them; at least 3 x 3
  /// 1 for the interior nodes of `box`, row by row; empty: all but its outermost ring.
  std::vector<std::uint8_t> interior;

  bool is_rectangle() const { return interior.empty(); }

  /// Whether node (i,j) of the grid is interior.
  bool holds(int i, int j) const {
    if (i <= box.i0 || i >= box.i1 || j <= box.j0 || j >= box.j1) return false;
    return is_rectangle() || interior[(j - box.j0) * std::size_t(box.columns()) + (i - box.i0)];
  }

  int interior_count() const;

  friend bool operator==(const Patch&, const Patch&) = default;
};

/// The cells of its parts, which are solved together. A node is interior if all its four cells are
/// inside; the others are the rim.
struct Region {
  Box box;                 ///< smallest box around all parts; in nodes
  std::vector<Box> parts;  ///< boxes whose cells form the region; `box` itself if it is one

  /// Its interior nodes, in the order of the first of each patch, row by row; empty: there are
  /// none, so that it is too small to solve.
  std::vector<Patch> patches = {};

  bool is_solved() const { return !patches.empty(); }

  friend bool operator==(const Region&, const Region&) = default;
};

/// Replaces boxes that share a node by their common box, until none do. Removes empty boxes. The
/// result does not depend on the order of `boxes`; it is sorted by first row, then by first column.
std::vector<Box> merged(std::span<const Box> boxes);

/// The regions that `boxes` form, none of them empty; islands in the order of `merged`. A box less
/// than two nodes wide has no cell, so it is not a part of a union.
std::vector<Region> combine(std::span<const Box> boxes, Combine how);

}  // namespace pliant
