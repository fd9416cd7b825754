#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pliant/core/grid.hpp"

namespace pliant {

/// How what several forces select becomes one solve or several. SPEC 5.
enum class Combine {
  Box,      ///< one box around everything: the thesis
  Islands,  ///< boxes that share a node merge into their common box; each is solved by itself
  Union,    ///< the cells of all boxes together are one domain, whatever its outline
};

/// What is solved together: the cells of its parts. A node is interior when all its four cells are
/// inside; the others are the rim.
struct Region {
  Box box;                 ///< holds all of it; in nodes
  std::vector<Box> parts;  ///< boxes whose cells it is made of; the box itself when it is one

  friend bool operator==(const Region&, const Region&) = default;
};

/// Boxes that share a node become their common box, until none do. Empty boxes go. The result does
/// not depend on the order of `boxes`; it is in the order of first rows, then of first columns.
std::vector<Box> merged(std::span<const Box> boxes);

/// The regions that `boxes` make, none of them empty; those of islands in the order of `merged`.
/// A box less than two nodes wide has no cell, and so no part in a union.
std::vector<Region> combine(std::span<const Box> boxes, Combine how);

/// Interior nodes of a region that one system of equations is for: those of a rectangle, or as many
/// as neighbour each other, diagonally too.
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

/// The patches of a region, in the order of their first interior nodes, row by row; none when it
/// has no interior node.
std::vector<Patch> patches_of(const Region& region);

}  // namespace pliant
