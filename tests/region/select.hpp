#pragma once

#include <span>
#include <vector>

#include "pliant/region/region.hpp"

namespace pliant {

/// A selection on nodes (#nodes x 3, world space).
inline Selection select_region(const Grid& grid, const PlacedNodes& nodes,
                               std::span<const SampledForce> forces, Combine how = Combine::Box,
                               std::span<const int> selectors = {}) {
  NodeTiles tiles;
  tiles.update(grid, nodes);
  return reselected({}, tiles, forces, how, selectors);
}

/// The load in a region, on the nodes of its box, world space.
inline Field assemble_load(const Grid& grid, const PlacedNodes& nodes,
                           std::span<const SampledForce> forces, const Selection& selection,
                           std::size_t region = 0) {
  return assemble_load(grid, nodes, forces, selection, region, selection.regions[region].box,
                       Matrix3d::Identity(), {});
}

}  // namespace pliant
