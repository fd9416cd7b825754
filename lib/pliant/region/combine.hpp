#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pliant/core/edges.hpp"
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
  /// 1 for the interior nodes of `box`, row by row; empty: all of `inner()`.
  std::vector<std::uint8_t> interior;

  bool is_ring_u = false;  ///< it goes all round a closed grid along u, and has no rim at i0 and i1
  bool is_ring_v = false;  ///< likewise along v
  Edges edges = {};        ///< those of its box; along a ring they do not matter
  bool has_held_nodes = false;  ///< `interior` lacks some that are held, with their slopes free
  bool is_held_within = false;  ///< its nodes hold it, or a goal does, where its edges do not

  /// Whether its plate is a rectangle with a rim all around.
  bool is_rectangle() const {
    return interior.empty() && !is_ring_u && !is_ring_v && !edges.have_free();
  }

  /// Whether its edges hold it: a clamped one, or two pinned ones, since it turns about a single
  /// one; or held nodes or a goal do. A static plate has no solution otherwise.
  bool is_held() const;

  /// The box without its outermost columns and rows, but for those of a ring and free ones.
  Box inner() const {
    const auto rim = [](bool is_ring, Edge edge) { return !is_ring && edge != Edge::Free ? 1 : 0; };
    return {box.i0 + rim(is_ring_u, edges.u0), box.i1 - rim(is_ring_u, edges.u1),
            box.j0 + rim(is_ring_v, edges.v0), box.j1 - rim(is_ring_v, edges.v1)};
  }

  /// Whether node (i,j) is interior; counted as in `box`.
  bool holds(int i, int j) const {
    if (!inner().contains(i, j)) return false;
    return interior.empty() ||
           interior[(j - box.j0) * std::size_t(box.columns()) + (i - box.i0)] != 0;
  }

  /// The grid of its nodes, with the spacings of `of`: closed where it is a ring.
  Grid grid(const Grid& of) const {
    return {box.columns(), box.rows(), of.hu, of.hv, is_ring_u, is_ring_v};
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
/// The grid matters only if it is closed.
std::vector<Box> merged(std::span<const Box> boxes, const Grid& grid = {});

/// The regions that `boxes` form, none of them empty; islands in the order of `merged`. A box less
/// than two nodes wide has no cell, so it is not a part of a union. The grid matters only if it is
/// closed: a common box is then the shortest around the others, counted round, and a region that
/// contains all columns (rows) is a ring.
std::vector<Region> combine(std::span<const Box> boxes, Combine how, const Grid& grid = {});

}  // namespace pliant
