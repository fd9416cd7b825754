#pragma once

#include <vector>

#include "pliant/core/grid.hpp"
#include "pliant/plate/outline/outline.hpp"

namespace pliant {

/// The most rectangles in a cover.
inline constexpr int max_cover_rectangles = 8;

/// Rectangles of interior nodes, without rims, that together contain all interior nodes of an
/// outline and no other nodes. They overlap: if one ends inside the plate, the overlap with the
/// next one along u or v is at least a quarter of the shorter one. Each is as large as the outline
/// allows. Sorted by ascending size, then by position. Empty if no cover with few rectangles
/// exists, as for ragged outlines. docs/model.md, "Overlapping rectangles". O(nodes). Internal to
/// plate.
std::vector<Box> cover_by_rectangles(const Outline& outline);

}  // namespace pliant
