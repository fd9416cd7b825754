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

/// Selects by distance, strictly less than each radius, on nodes (#nodes x 3, world space). A box
/// over (u,v) is a box of nodes, and it holds also the nodes that lie outside every sphere: that is
/// what makes the region an M x N grid. `how` makes regions of the boxes. `selectors` names for
/// each force the one whose deformation box is its own; empty: each has its own. Requires: #nodes =
/// grid.node_count().
Selection select_region(const Grid& grid, const PlacedNodes& nodes,
                        std::span<const SampledForce> forces, Combine how = Combine::Box,
                        std::span<const int> selectors = {});

/// The boxes of one force by itself.
ForceSelection boxes_of(const NodeTiles& tiles, const SampledForce& force);

/// Selects anew into `selection`, which came from here or is empty, on the nodes of `tiles`. Where
/// all deformation boxes are as before so are the regions: nothing is allocated then. Returns
/// whether they are. A program's own function is asked about every node, others only where the
/// answer counts.
bool reselect(Selection& selection, const NodeTiles& tiles, std::span<const SampledForce> forces,
              Combine how, std::span<const int> selectors = {});

/// The same selection with `others`, boxes that no force selects, taking part in its regions.
/// In a box or union every force acts in the one region; of islands in the one that holds the
/// deformation box of its `selector`, which is empty for a force that acts in none.
Selection recombined(Selection selection, Combine how, std::span<const Box> others = {});

/// Whether a force box has a node of the region, rim included.
bool overlaps(const Region& region, const Box& force);

/// The sum of all forces that act in one region, on each node of its box (#nodes x 3, row = j *
/// columns + i counted within the box, world space): force k acts on the nodes inside its force
/// box. Forces add up in the order given. Requires: `selection` is what `select_region` gave for
/// the same arguments, and has that region.
Field assemble_load(const Grid& grid, const PlacedNodes& nodes,
                    std::span<const SampledForce> forces, const Selection& selection,
                    std::size_t region = 0);

/// The same on the nodes of a box, a part of the region's, in object space: each row times
/// `to_object`, as `vectors_to_object` has it. The result takes the memory of `reuse`.
Field assemble_load(const Grid& grid, const PlacedNodes& nodes,
                    std::span<const SampledForce> forces, const Selection& selection,
                    std::size_t region, const Box& box, const Matrix3d& to_object, Field reuse);

/// `patches` are those of the region that the force acts in, `box` its force box.
Push push_of(const Grid& grid, const PlacedNodes& nodes, const SampledForce& force, const Box& box,
             std::span<const Patch> patches);

/// Whether a force moves any interior node of the patches: stops at the first.
bool pushes(const Grid& grid, const PlacedNodes& nodes, const SampledForce& force, const Box& box,
            std::span<const Patch> patches);

}  // namespace pliant
