#pragma once

#include <span>
#include <vector>

#include "pliant/body/settings.hpp"
#include "pliant/core/field.hpp"
#include "pliant/core/grid.hpp"
#include "pliant/region/combine.hpp"

namespace pliant {

// The work that `Release::Recover` adds to a frame. SPEC 6; docs/model.md, "Release". Internal to
// body.
//
// A node is *unsettled* if the last solve moved it and left it with a displacement, or a motion
// over the frame, that is not below 1e-6 of the diagonal of its region. An unsettled node that is
// not in the interior of any force's region *recovers*: it is selected together with its eight
// neighbours, so that it is interior itself. All nodes outside the interior of the resulting
// regions *settle*: they are put at rest. So the rim is at rest, and without forces a region never
// grows: from some frame on it stays the same, and its motion dies out.

/// The nodes that recover, ascending. `unsettled` is empty if no node ever is; `regions` are those
/// of the forces. `marks` is workspace, and the result reuses the memory of `reuse`.
std::vector<int> recovering_nodes(const Grid& grid, const NodeMarks& unsettled,
                                  std::span<const Region> regions, NodeMarks& marks,
                                  std::vector<int> reuse);

/// Boxes around these nodes (ascending) and their neighbours; no two boxes share a node.
std::vector<Box> boxes_around(const Grid& grid, std::span<const int> nodes);

/// The nodes that are interior to no region and not at rest without velocity, ascending. `marks` is
/// workspace, and the result reuses the memory of `reuse`.
std::vector<int> settling_nodes(const Grid& grid, const Field& rest, const Field& positions,
                                const Field& velocities, std::span<const Region> regions,
                                NodeMarks& marks, std::vector<int> reuse);

/// The length below which displacement and motion count as settled: 1e-6 of the diagonal of the
/// bounding box of the region's rest positions (#nodes x 3, object space).
double settling_length(const Grid& grid, const Field& rest, const Region& region);

}  // namespace pliant
