#include "pliant/plate/domain_rows.hpp"

#include <algorithm>

#include "pliant/core/expects.hpp"

namespace pliant {

DomainRows::DomainRows(const Grid& grid, const InteriorMask& interior) {
  PLIANT_EXPECTS(interior.size() == static_cast<std::size_t>(grid.node_count()));
  constexpr int rows_of_block = 16;
  const int M = grid.columns;
  for (int first_row = 1; first_row < grid.rows - 1; first_row += rows_of_block) {
    Block block{runs_.size(), 0, edges_.size(), 0};
    const int last_row = std::min(first_row + rows_of_block, grid.rows - 1);
    for (int j = first_row; j < last_row; ++j) {
      for (int i = 1; i < M - 1; ++i) {
        const int node = grid.node(i, j);
        if (!interior[node]) continue;
        if (!interior[node - 1]) runs_.push_back({node, 0});
        ++runs_.back().count;
        const int along_u = !interior[node - 1] + !interior[node + 1];
        const int along_v = !interior[node - M] + !interior[node + M];
        if (along_u + along_v > 0) edges_.push_back({node, along_u, along_v});
      }
    }
    block.run_count = runs_.size() - block.first_run;
    block.edge_count = edges_.size() - block.first_edge;
    if (block.run_count > 0) blocks_.push_back(block);
  }
}

std::size_t DomainRows::memory() const {
  return runs_.capacity() * sizeof(Run) + edges_.capacity() * sizeof(Edge) +
         blocks_.capacity() * sizeof(Block);
}

}  // namespace pliant
