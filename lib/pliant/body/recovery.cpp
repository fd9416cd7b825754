#include "pliant/body/recovery.hpp"

#include <algorithm>

#include "pliant/core/expects.hpp"
#include "pliant/region/closed_boxes.hpp"

namespace pliant {
namespace {

void mark_interiors(const Grid& grid, std::span<const Region> regions, NodeMarks& marks) {
  marks.assign(static_cast<std::size_t>(grid.node_count()), 0);
  for (const Region& region : regions) {
    for (const Patch& patch : region.patches) {
      const Box inner = patch.inner();
      for (int j = inner.j0; j <= inner.j1; ++j) {
        for (int i = inner.i0; i <= inner.i1; ++i) {
          if (patch.holds(i, j)) marks[grid.node_round(i, j)] = 1;
        }
      }
    }
  }
}

}  // namespace

std::vector<int> recovering_nodes(const Grid& grid, const NodeMarks& unsettled,
                                  std::span<const Region> regions, NodeMarks& marks,
                                  std::vector<int> reuse) {
  reuse.clear();
  if (std::find(unsettled.begin(), unsettled.end(), 1) == unsettled.end()) return reuse;
  mark_interiors(grid, regions, marks);
  for (int node = 0; node < grid.node_count(); ++node) {
    if (unsettled[node] && !marks[node]) reuse.push_back(node);
  }
  return reuse;
}

std::vector<Box> boxes_around(const Grid& grid, std::span<const int> nodes) {
  std::vector<Box> runs;  // along u
  for (const int node : nodes) {
    const int i = node % grid.columns, j = node / grid.columns;
    Box around = {i - 1, i + 1, j - 1, j + 1};
    if (!grid.is_closed_u) around = intersection(around, {0, grid.columns - 1, j - 1, j + 1});
    if (!grid.is_closed_v) around = intersection(around, {i - 1, i + 1, 0, grid.rows - 1});
    const bool goes_on = !runs.empty() && runs.back().j1 == around.j1 && runs.back().i1 == i;
    goes_on ? runs.back().include(around) : runs.push_back(around);
  }
  for (Box& run : runs) run = placed(grid, run);
  return merged(runs, grid);
}

std::vector<int> settling_nodes(const Grid& grid, const Field& rest, const Field& positions,
                                const Field& velocities, std::span<const Region> regions,
                                NodeMarks& marks, std::vector<int> reuse) {
  mark_interiors(grid, regions, marks);
  reuse.clear();
  for (int node = 0; node < grid.node_count(); ++node) {
    if (marks[node]) continue;
    const bool is_at_rest = positions.row(node) == rest.row(node) && velocities.row(node).isZero(0);
    if (!is_at_rest) reuse.push_back(node);
  }
  return reuse;
}

double settling_length(const Grid& grid, const Field& rest, const Region& region) {
  PLIANT_EXPECTS(!region.parts.empty());
  Eigen::RowVector3d low = rest.row(grid.node(region.parts[0].i0, region.parts[0].j0));
  Eigen::RowVector3d high = low;
  for (const Box& part : region.parts) {
    for (int j = part.j0; j <= part.j1; ++j) {
      for_each_stretch(grid, part.i0, part.i1, j, [&](int node, int, int count) {
        const auto row = rest.middleRows(node, count);
        low = low.cwiseMin(row.colwise().minCoeff());
        high = high.cwiseMax(row.colwise().maxCoeff());
      });
    }
  }
  return 1e-6 * length_of(high - low);
}

}  // namespace pliant
