#pragma once

#include <vector>

#include "pliant/core/grid.hpp"
#include "pliant/plate/domain.hpp"

namespace pliant {

/// The most rectangles that a cover has.
inline constexpr int max_cover_rectangles = 8;

/// Rectangles of interior nodes, rims not included, that together hold all interior nodes of a mask
/// and nothing else, and that overlap: where one ends inside the plate, the next one along u or v
/// shares at least a quarter of the shorter one with it. Each is as large as the outline lets it
/// be. In ascending order of size, then of place. Empty where there is no such cover of few
/// rectangles: ragged outlines. docs/model.md, "Overlapping rectangles". O(nodes). Not for other
/// rooms.
std::vector<Box> cover_by_rectangles(const Grid& grid, const InteriorMask& interior);

}  // namespace pliant
