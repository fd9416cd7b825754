#pragma once

#include <cstddef>
#include <vector>

#include "pliant/core/grid.hpp"
#include "pliant/plate/outline/outline.hpp"
#include "pliant/plate/outline/row_blocks.hpp"

namespace pliant {

/// A rectangle of a cover, and the nodes of the plate where its solution with clamped sides leaves
/// a rest. docs/model.md, "Overlapping rectangles". Internal to plate.
struct Subdomain {
  Box box;                              ///< of interior nodes
  std::vector<RowBlocks::Edge> facing;  ///< nodes of `box` beside interior nodes outside it
  std::vector<long> around;             ///< interior nodes outside `box` that the stencil reaches
};

/// Requires: the box's nodes are interior.
Subdomain subdomain_of(const Outline& outline, const Box& box);

/// Moves rectangles that no stencil connects with one another, the largest among them, behind the
/// others: a round visits them once, as their order does not matter. Returns their number.
/// Requires: sorted by ascending size.
std::size_t move_independent_back(std::vector<Box>& cover);

}  // namespace pliant
