#pragma once

#include <cstdint>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/grid.hpp"
#include "pliant/plate/plate.hpp"

namespace pliant {

// Plates whose outline is not a rectangle: SPEC 5, union; docs/model.md, eq. (12) to (14).
// `interior` is 1 for each interior node of the grid and 0 for the others (#nodes, row =
// grid.node(i, j)); it is empty if the plate is the whole rectangle, whose interior is all but the
// outermost nodes. Interior nodes have all eight neighbours in the grid. If two nodes that are two
// steps apart along u or v are interior, so is the one between them, as for every outline that
// follows cells. Unknowns are numbered row by row.
using InteriorMask = std::vector<std::uint8_t>;

/// Number of unknowns.
int unknown_count(const Grid& grid, const InteriorMask& interior);

/// The interior rows of a field on all nodes (#nodes x 3 -> #unknowns x 3).
Field interior_of(const Grid& grid, const InteriorMask& interior, const Field& nodes);

/// `nodes` with its interior rows replaced by `unknowns`, all other rows unchanged.
Field with_interior(const Grid& grid, const InteriorMask& interior, Field nodes,
                    const Field& unknowns);

/// `apply_stencil` for any outline. A neighbour that is not an interior node belongs to the rim,
/// and the node behind it is a ghost: the current node mirrored, even if another node of the grid
/// is there. Tangents are those of rim nodes on the grid's outermost rows and columns; at all other
/// rim nodes the slope is 0.
Field apply_stencil(const Grid& grid, const InteriorMask& interior, const Stiffness& stiffness,
                    const EdgeTangents& tangents, const Field& w);

}  // namespace pliant
