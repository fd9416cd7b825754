#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/grid.hpp"
#include "pliant/region/region.hpp"

namespace pliant {

// What `Release::Recover` adds to a frame. SPEC 6; docs/model.md, "Release". Not for other rooms.
//
// A node is *unsettled* when the last solve moved it and left it with a displacement or a motion
// over the frame that is not below 1e-6 of the diagonal of its region. An unsettled node that no
// force's region holds in its interior *recovers*: it counts as selected, together with its eight
// neighbours, so that it is interior itself. All nodes outside the interior of what is then solved
// *settle*: they are put at rest. So the rim is at rest, and without forces a region never grows:
// from some frame on it stays, and its motion dies out.

/// 1 for each node that is unsettled (#nodes), or nothing where none ever is.
using NodeMarks = std::vector<std::uint8_t>;

/// Nodes that recover, as boxes of nodes.
struct Recovering {
  int node_count = 0;
  std::vector<Box> boxes;  ///< with the neighbours; no two share a node
};
/// `patches` are those that forces hold, of each region. `marks` is room to work in.
Recovering recovering_nodes(const Grid& grid, const NodeMarks& unsettled,
                            std::span<const std::vector<Patch>> patches, NodeMarks& marks);

/// The nodes that are interior to no patch, and neither at rest nor without velocity, ascending.
/// `marks` is room to work in, and the result takes the memory of `reuse`.
std::vector<int> settling_nodes(const Grid& grid, const Field& rest, const Field& positions,
                                const Field& velocities,
                                std::span<const std::vector<Patch>> patches, NodeMarks& marks,
                                std::vector<int> reuse);

/// The length below which displacement and motion settle: 1e-6 of the diagonal of the box around
/// the region's rest positions (#nodes x 3, object space).
double settling_length(const Grid& grid, const Field& rest, const Region& region);

}  // namespace pliant
