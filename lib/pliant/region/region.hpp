#pragma once

#include <span>

#include "pliant/core/field.hpp"
#include "pliant/core/grid.hpp"
#include "pliant/forces/force.hpp"
#include "pliant/region/combine.hpp"
#include "pliant/region/node_tiles.hpp"
#include "pliant/region/placed_nodes.hpp"
#include "pliant/region/selection.hpp"

namespace pliant {

/// The boxes of one force alone.
ForceSelection boxes_of(const NodeTiles& tiles, const SampledForce& force);

/// Selects by distance, strictly less than each radius, on the nodes of `tiles`, in the memory of
/// `earlier`: an earlier result, or empty. A box over (u,v) is a box of nodes and also contains
/// nodes that are outside every sphere: this makes the region an M x N grid. `how` forms regions
/// from the boxes. `selectors` has for each force the index of the force whose deformation box it
/// uses; empty: each uses its own. `others` are boxes that no force selects, but that are solved
/// too. If all boxes are unchanged, so are the regions, and nothing is allocated. A program's own
/// function is asked for every node, other forces only for nodes that can change a box.
Selection reselected(Selection earlier, const NodeTiles& tiles,
                     std::span<const SampledForce> forces, Combine how,
                     std::span<const int> selectors = {}, std::span<const Box> others = {});

/// The same selection with regions formed from its boxes and from `others`, boxes that no force
/// selects. In a box or union every force acts in the one region; with islands, in the one that
/// contains the deformation box of its `selector`; if that box is empty, in none.
Selection recombined(Selection selection, Combine how, std::vector<Box> others = {});

/// Whether a force box contains a node of the region, rim included.
bool overlaps(const Grid& grid, const Region& region, const Box& force);

/// The load of all forces that act in one region, on each node of a box that is part of the
/// region's box (row = j * columns + i counted within it), in object space: each row times
/// `to_object`, as in `vectors_to_object`. Force k acts on the nodes inside its force box. Forces
/// are added in the given order. Requires: `selection` is the result of `reselected` for the same
/// arguments, and contains that region. The result reuses the memory of `reuse`.
Field assemble_load(const Grid& grid, const PlacedNodes& nodes,
                    std::span<const SampledForce> forces, const Selection& selection,
                    std::size_t region, const Box& box, const Matrix3d& to_object, Field reuse);

/// `patches` are those of the region that the force acts in, `box` its force box.
Push push_of(const Grid& grid, const PlacedNodes& nodes, const SampledForce& force, const Box& box,
             std::span<const Patch> patches);

/// Whether a force moves any interior node of the patches; stops at the first.
bool pushes(const Grid& grid, const PlacedNodes& nodes, const SampledForce& force, const Box& box,
            std::span<const Patch> patches);

}  // namespace pliant
