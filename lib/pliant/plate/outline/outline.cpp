#include "pliant/plate/outline/outline.hpp"

#include <utility>

#include "pliant/core/expects.hpp"

namespace pliant {

Outline::Outline(const Grid& grid) : Outline(grid, Edges{}) {}

Outline::Outline(const Grid& grid, const Edges& edges) : grid_(grid), edges_(edges) {
  if (grid.is_closed_u) edges_.u0 = edges_.u1 = Edge::Clamped;
  if (grid.is_closed_v) edges_.v0 = edges_.v1 = Edge::Clamped;
  const auto has_rim = [](bool is_closed, Edge edge) { return !is_closed && edge != Edge::Free; };
  inner_ = {has_rim(grid.is_closed_u, edges_.u0) ? 1 : 0,
            grid.columns - (has_rim(grid.is_closed_u, edges_.u1) ? 2 : 1),
            has_rim(grid.is_closed_v, edges_.v0) ? 1 : 0,
            grid.rows - (has_rim(grid.is_closed_v, edges_.v1) ? 2 : 1)};
  unknowns_ = inner_.is_empty() ? 0 : inner_.columns() * inner_.rows();
  is_rectangle_ = grid.is_open() && !edges_.have_free();
}

Outline::Outline(const Grid& grid, InteriorMask mask) : Outline(grid) {
  if (mask.empty()) return;
  PLIANT_EXPECTS(mask.size() == static_cast<std::size_t>(grid.node_count()));
  unknowns_ = static_cast<int>(std::count(mask.begin(), mask.end(), std::uint8_t{1}));
  mask_ = std::move(mask);
  is_rectangle_ = false;
}

Outline::Outline(const Grid& grid, const Edges& edges, InteriorMask mask) : Outline(grid, edges) {
  PLIANT_EXPECTS(mask.size() == static_cast<std::size_t>(grid.node_count()));
  unknowns_ = static_cast<int>(std::count(mask.begin(), mask.end(), std::uint8_t{1}));
  mask_ = std::move(mask);
  is_rectangle_ = false;
  has_held_nodes_ = true;
}

bool Outline::holds_all(const Run& nodes) const {
  if (!grid_.is_closed_v && (nodes.j < 1 || nodes.j > grid_.rows - 2)) return false;
  if (mask_.empty()) return grid_.is_closed_u || (nodes.i0 >= inner_.i0 && nodes.i1 <= inner_.i1);
  const auto first = mask_.begin() + grid_.node_round(nodes.i0, nodes.j);
  return std::find(first, first + nodes.count(), std::uint8_t{0}) == first + nodes.count();
}

bool Outline::holds_round(int i, int j) const {
  if (!mask_.empty()) return mask_[static_cast<std::size_t>(grid_.node_round(i, j))] != 0;
  return (grid_.is_closed_u || (i >= inner_.i0 && i <= inner_.i1)) &&
         (grid_.is_closed_v || (j >= inner_.j0 && j <= inner_.j1));
}

std::vector<int> numbers_of_unknowns(const Outline& outline) {
  std::vector<int> numbers(static_cast<std::size_t>(outline.grid().node_count()), -1);
  int next = 0;
  outline.for_each_run([&](const Outline::Run& run) {
    for (int i = run.i0; i <= run.i1; ++i) {
      numbers[static_cast<std::size_t>(outline.grid().node(i, run.j))] = next++;
    }
  });
  return numbers;
}

bool have_same_nodes(const Outline& a, const Outline& b) {
  return a.grid().columns == b.grid().columns && a.grid().rows == b.grid().rows &&
         a.grid().is_closed_u == b.grid().is_closed_u &&
         a.grid().is_closed_v == b.grid().is_closed_v && a.edges() == b.edges() &&
         a.has_held_nodes() == b.has_held_nodes() && a.mask() == b.mask();
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
