#include "pliant/region/node_tiles.hpp"

#include <algorithm>
#include <limits>

#include "pliant/core/expects.hpp"

namespace pliant {
namespace {

constexpr int tile_size = batch_size;
constexpr double infinity = std::numeric_limits<double>::infinity();

using Lanes = Eigen::Array<double, 8, 1>;  // enough registers for all three components
static_assert(batch_size % 8 == 0);

// The least and the largest of the numbers so far, in parallel lanes.
struct Extremes {
  Lanes low = Lanes::Constant(infinity);
  Lanes high = Lanes::Constant(-infinity);
  Lanes unsound = Lanes::Zero();  // NaN once a number was not finite

  // Pads the last lanes with the first number.
  void include(double* numbers, int count) {
    const int filled = (count + 7) / 8 * 8;
    std::fill(numbers + count, numbers + filled, numbers[0]);
    Lanes least = low, largest = high, sum = unsound;
    for (int k = 0; k < filled; k += 8) {
      const Lanes lanes = Eigen::Map<const Lanes>(numbers + k);
      least = least.min(lanes);
      largest = largest.max(lanes);
      sum += lanes - lanes;  // NOLINT(misc-redundant-expression): 0 only if finite
    }
    low = least;
    high = largest;
    unsound = sum;
  }

  bool are_finite() const { return unsound.sum() == 0; }
};

}  // namespace

void NodeTiles::update(const Grid& grid, const PlacedNodes& nodes) {
  PLIANT_EXPECTS(nodes.count() == grid.node_count());
  grid_ = grid;
  nodes_ = nodes;
  are_finite_ = true;
  tiles_.clear();
  for (int j = 0; j < grid.rows; j += tile_size) {
    for (int i = 0; i < grid.columns; i += tile_size) {
      tiles_.emplace_back().box =
          intersection({i, i + tile_size - 1, j, j + tile_size - 1}, grid.box());
    }
  }
  for (Tile& tile : tiles_) fill(tile);
}

void NodeTiles::fill(Tile& tile) {
  Extremes of[3];
  for (int j = tile.box.j0; j <= tile.box.j1; ++j) {
    Batch batch = nodes_->batch(grid_.node(tile.box.i0, j), tile.box.columns());
    of[0].include(batch.x, batch.count);
    of[1].include(batch.y, batch.count);
    of[2].include(batch.z, batch.count);
  }
  for (int k = 0; k < 3; ++k) {
    const bool are_sound = of[k].are_finite();
    // Numbers that are not finite have no bound.
    tile.low[k] = are_sound ? of[k].low.minCoeff() : -infinity;
    tile.high[k] = are_sound ? of[k].high.maxCoeff() : infinity;
    are_finite_ = are_finite_ && are_sound;
  }
}

}  // namespace pliant
