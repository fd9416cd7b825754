#pragma once

#include <vector>

#include "pliant/core/grid.hpp"
#include "pliant/region/placed_nodes.hpp"

namespace pliant {

/// The nodes of a grid in tiles, each with its bounding box in world space, so that a force that is
/// far away need not visit every node. Costs one pass over the nodes.
class NodeTiles {
 public:
  struct Tile {
    Box box;                    ///< its nodes
    Vector3d low = {0, 0, 0};   ///< the least of their x, y and z, world [length]
    Vector3d high = {0, 0, 0};  ///< the largest
  };

  /// Computes the tiles of these nodes. Keeps a reference to their positions. Allocates nothing
  /// while the grid is the same. Requires: nodes.count() = grid.node_count().
  void update(const Grid& grid, const PlacedNodes& nodes);

  const Grid& grid() const { return grid_; }
  const PlacedNodes& nodes() const { return *nodes_; }
  const std::vector<Tile>& tiles() const { return tiles_; }  ///< row by row

  /// Whether all nodes are finite.
  bool are_finite() const { return are_finite_; }

 private:
  void fill(Tile& tile);

  Grid grid_;
  std::optional<PlacedNodes> nodes_;
  std::vector<Tile> tiles_;
  bool are_finite_ = true;
};

}  // namespace pliant
