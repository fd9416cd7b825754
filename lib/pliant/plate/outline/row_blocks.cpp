#include "pliant/plate/outline/row_blocks.hpp"

namespace pliant {

RowBlocks::RowBlocks(const Outline& outline) {
  constexpr int rows_of_block = 16;
  const Grid& grid = outline.grid();
  int place = -1;  // of the last block, counted from the first row
  outline.for_each_run([&](const Outline::Run& run) {
    const auto& [j, i0, i1] = run;
    if ((j - 1) / rows_of_block != place) {
      place = (j - 1) / rows_of_block;
      blocks_.push_back({runs_.size(), 0, edges_.size(), 0});
    }
    runs_.push_back({grid.node(i0, j), run.count()});
    ++blocks_.back().run_count;
    for (int i = i0; i <= i1; ++i) {
      const int along_u = (i == i0) + (i == i1);
      const int along_v = !outline.holds(i, j - 1) + !outline.holds(i, j + 1);
      if (along_u + along_v == 0) continue;
      edges_.push_back({grid.node(i, j), along_u, along_v});
      ++blocks_.back().edge_count;
    }
  });
}

std::size_t RowBlocks::memory() const {
  return runs_.capacity() * sizeof(Run) + edges_.capacity() * sizeof(Edge) +
         blocks_.capacity() * sizeof(Block);
}

}  // namespace pliant
