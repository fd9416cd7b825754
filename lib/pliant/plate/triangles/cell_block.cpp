#include "pliant/plate/triangles/cell_block.hpp"

#include <algorithm>

namespace pliant {

ReducedUnknowns::ReducedUnknowns(const TriangleCells& cells, int mass_count)
    : places(static_cast<std::size_t>(cells.unknown_count()), -1) {
  constexpr int none = -1, several = -2;
  std::vector<int> owners(places.size(), none);  // the block of each unknown
  for (int block = 0; block < cells.block_count(); ++block) {
    for (int k = cells.block_starts[block]; k < cells.block_starts[block + 1]; ++k) {
      for_each_unknown(cells, cells.cells[k], [&](const CellUnknown& unknown) {
        int& owner = owners[unknown.index];
        owner = owner == none || owner == block ? block : several;
      });
    }
  }
  std::vector<bool> has_inner(static_cast<std::size_t>(cells.block_count()));
  for (int unknown = 0; unknown < cells.unknown_count(); ++unknown) {
    const int block = owners[unknown];
    if (unknown < mass_count || block < 0) {
      places[unknown] = count++;
    } else {
      has_inner[block] = true;
    }
  }
  std::fill(owners.begin(), owners.end(), none);  // now the last block of each that is left
  for (int block = 0; block < cells.block_count(); ++block) {
    if (has_inner[block]) blocks.push_back(block);
    std::size_t left = 0;
    for (int k = cells.block_starts[block]; k < cells.block_starts[block + 1]; ++k) {
      for_each_unknown(cells, cells.cells[k], [&](const CellUnknown& unknown) {
        if (places[unknown.index] < 0 || owners[unknown.index] == block) return;
        owners[unknown.index] = block;
        ++left;
      });
    }
    pairs += left * (left + 1) / 2;
  }
}

template <class Real>
void CellBlock<Real>::compute(const TriangleCells& cells, int block, const ReducedUnknowns& reduced,
                              const Bending& bending, const CellFactors* factors) {
  const int first = cells.block_starts[block], last = cells.block_starts[block + 1];
  unknowns_.clear();
  for (int k = first; k < last; ++k) {
    for_each_unknown(cells, cells.cells[k], [&](const CellUnknown& unknown) {
      if (std::find(unknowns_.begin(), unknowns_.end(), unknown.index) == unknowns_.end()) {
        unknowns_.push_back(unknown.index);
      }
    });
  }
  const auto inner_end = std::stable_partition(
      unknowns_.begin(), unknowns_.end(), [&](int unknown) { return reduced.places[unknown] < 0; });
  inner_count_ = static_cast<int>(inner_end - unknowns_.begin());
  matrix_.assign(unknowns_.size() * unknowns_.size(), Real{0});
  std::vector<std::pair<int, CellUnknown>> used;
  for (int k = first; k < last; ++k) {
    const MorleyCell cell(cells.cells[k].shape);
    const std::array<Curvature, 6> by_value = cell.by_value();
    const Bending own = bending_at(bending, factors, k);
    std::array<Curvature, 6> moment_by_value;
    for (int n = 0; n < 6; ++n) moment_by_value[n] = moments(own, by_value[n]);
    used.clear();
    for_each_unknown(cells, cells.cells[k], [&](const CellUnknown& unknown) {
      const auto place = std::find(unknowns_.begin(), unknowns_.end(), unknown.index);
      used.emplace_back(static_cast<int>(place - unknowns_.begin()), unknown);
    });
    for (const auto& [row, a] : used) {
      for (const auto& [column, b] : used) {
        if (row > column) continue;
        const Curvature &h = by_value[a.value], &m = moment_by_value[b.value];
        const Real product = Real{h[0]} * m[0] + Real{h[1]} * m[1] + Real{h[2]} * m[2];
        matrix_[index(row, column)] += cell.area * a.sign * b.sign * product;
      }
    }
  }
  for (int p = 0; p < inner_count_; ++p) {
    for (int row = p + 1; row < size(); ++row) {
      const Real factor = at(p, row) / at(p, p);
      for (int column = row; column < size(); ++column) {
        matrix_[index(row, column)] -= factor * at(p, column);
      }
    }
  }
}

template class CellBlock<double>;
template class CellBlock<long double>;

}  // namespace pliant
