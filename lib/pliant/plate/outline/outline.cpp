#include "pliant/plate/outline/outline.hpp"

#include <utility>

#include "pliant/core/expects.hpp"

namespace pliant {

Outline::Outline(const Grid& grid) : grid_(grid) {
  unknowns_ = (grid.is_closed_u ? grid.columns : std::max(0, grid.columns - 2)) *
              (grid.is_closed_v ? grid.rows : std::max(0, grid.rows - 2));
  is_rectangle_ = grid.is_open();
}

Outline::Outline(const Grid& grid, InteriorMask mask) : Outline(grid) {
  if (mask.empty()) return;
  PLIANT_EXPECTS(mask.size() == static_cast<std::size_t>(grid.node_count()));
  unknowns_ = static_cast<int>(std::count(mask.begin(), mask.end(), std::uint8_t{1}));
  mask_ = std::move(mask);
  is_rectangle_ = false;
}

bool Outline::holds_all(const Run& nodes) const {
  if (!grid_.is_closed_v && (nodes.j < 1 || nodes.j > grid_.rows - 2)) return false;
  if (mask_.empty()) return grid_.is_closed_u || (nodes.i0 >= 1 && nodes.i1 <= grid_.columns - 2);
  const auto first = mask_.begin() + grid_.node_round(nodes.i0, nodes.j);
  return std::find(first, first + nodes.count(), std::uint8_t{0}) == first + nodes.count();
}

bool Outline::holds_round(int i, int j) const {
  if (!mask_.empty()) return mask_[static_cast<std::size_t>(grid_.node_round(i, j))] != 0;
  return (grid_.is_closed_u || (i > 0 && i < grid_.columns - 1)) &&
         (grid_.is_closed_v || (j > 0 && j < grid_.rows - 1));
}

bool have_same_nodes(const Outline& a, const Outline& b) {
  return a.grid().columns == b.grid().columns && a.grid().rows == b.grid().rows &&
         a.grid().is_closed_u == b.grid().is_closed_u &&
         a.grid().is_closed_v == b.grid().is_closed_v && a.mask() == b.mask();
}

Field interior_of(const Outline& outline, const Field& nodes) {
  PLIANT_EXPECTS(nodes.rows() == outline.grid().node_count());
  Field unknowns(outline.unknown_count(), 3);
  for (int component = 0; component < 3; ++component) {
    int row = 0;
    outline.for_each_run([&](const Outline::Run& run) {
      unknowns.col(component).segment(row, run.count()) =
          nodes.col(component).segment(outline.grid().node(run.i0, run.j), run.count());
      row += run.count();
    });
  }
  return unknowns;
}

Field with_interior(const Outline& outline, Field nodes, const Field& unknowns) {
  PLIANT_EXPECTS(nodes.rows() == outline.grid().node_count());
  PLIANT_EXPECTS(unknowns.rows() == outline.unknown_count());
  for (int component = 0; component < 3; ++component) {
    int row = 0;
    outline.for_each_run([&](const Outline::Run& run) {
      nodes.col(component).segment(outline.grid().node(run.i0, run.j), run.count()) =
          unknowns.col(component).segment(row, run.count());
      row += run.count();
    });
  }
  return nodes;
}

void clear_rim(const Outline& outline, Field& nodes) {
  PLIANT_EXPECTS(nodes.rows() == outline.grid().node_count());
  for (int component = 0; component < 3; ++component) {
    auto column = nodes.col(component);
    Eigen::Index end = 0;  // of the last run
    outline.for_each_run([&](const Outline::Run& run) {
      const Eigen::Index first = outline.grid().node(run.i0, run.j);
      column.segment(end, first - end).setZero();
      end = first + run.count();
    });
    column.tail(column.size() - end).setZero();
  }
}

}  // namespace pliant
