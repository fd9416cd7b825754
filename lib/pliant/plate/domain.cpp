#include "pliant/plate/domain.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/plate/stencil.hpp"

namespace pliant {
namespace {

// Calls f(node, row) for each interior node of a mask, row by row.
template <class F>
void for_each_unknown(const Grid& grid, const InteriorMask& interior, const F& f) {
  PLIANT_EXPECTS(interior.size() == static_cast<std::size_t>(grid.node_count()));
  int row = 0;
  for (int node = 0; node < grid.node_count(); ++node) {
    if (interior[node]) f(node, row++);
  }
}

}  // namespace

int unknown_count(const Grid& grid, const InteriorMask& interior) {
  if (interior.empty()) return unknown_count(grid);
  return static_cast<int>(std::count(interior.begin(), interior.end(), std::uint8_t{1}));
}

Field interior_of(const Grid& grid, const InteriorMask& interior, const Field& nodes) {
  if (interior.empty()) return interior_of(grid, nodes);
  Field unknowns(unknown_count(grid, interior), 3);
  for_each_unknown(grid, interior, [&](int node, int row) { unknowns.row(row) = nodes.row(node); });
  return unknowns;
}

Field with_interior(const Grid& grid, const InteriorMask& interior, Field nodes,
                    const Field& unknowns) {
  if (interior.empty()) return with_interior(grid, std::move(nodes), unknowns);
  PLIANT_EXPECTS(nodes.rows() == grid.node_count());
  PLIANT_EXPECTS(unknowns.rows() == unknown_count(grid, interior));
  for_each_unknown(grid, interior, [&](int node, int row) { nodes.row(node) = unknowns.row(row); });
  return nodes;
}

Field apply_stencil(const Grid& grid, const InteriorMask& interior, const Stiffness& stiffness,
                    const EdgeTangents& tangents, const Field& w) {
  if (interior.empty()) return apply_stencil(grid, stiffness, tangents, w);
  PLIANT_EXPECTS(w.rows() == grid.node_count());
  const int M = grid.columns;
  const std::ptrdiff_t two_rows = std::ptrdiff_t{2} * M;
  const double hu = grid.hu;
  const double hv = grid.hv;
  const Stiffness scaled = scaled_stiffness(grid, stiffness);

  Field result(unknown_count(grid, interior), 3);
  for_each_unknown(grid, interior, [&](int node, int row) {
    const int i = node % M;
    const int j = node / M;
    const auto is_rim = [&](int other) { return interior[other] == 0; };
    for (int component = 0; component < 3; ++component) {
      const double* const p = w.col(component).data() + node;
      // Eq. (12): a ghost is this node mirrored at the rim; eq. (6) at the edges of the grid.
      const double ghost_u0 = i == 1 ? -2 * hu * tangents.su0[component] : 0;
      const double ghost_u1 = i == M - 2 ? 2 * hu * tangents.su1[component] : 0;
      const double ghost_v0 = j == 1 ? -2 * hv * tangents.sv0[component] : 0;
      const double ghost_v1 = j == grid.rows - 2 ? 2 * hv * tangents.sv1[component] : 0;
      const double left = is_rim(node - 1) ? p[0] + ghost_u0 : p[-2];
      const double right = is_rim(node + 1) ? p[0] + ghost_u1 : p[2];
      const double below = is_rim(node - M) ? p[0] + ghost_v0 : p[-two_rows];
      const double above = is_rim(node + M) ? p[0] + ghost_v1 : p[two_rows];
      const double uuuu = (left + right) - 4 * (p[-1] + p[1]) + 6 * p[0];
      const double vvvv = (below + above) - 4 * (p[-M] + p[M]) + 6 * p[0];
      const double uuvv = (p[-M - 1] + p[-M + 1] + p[M - 1] + p[M + 1]) -
                          2 * (p[-1] + p[1] + p[-M] + p[M]) + 4 * p[0];
      result(row, component) = scaled.b * uuuu + scaled.c * uuvv + scaled.d * vvvv;
    }
  });
  return result;
}

}  // namespace pliant
