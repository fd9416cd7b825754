#include "pliant/plate/operator.hpp"

#include <algorithm>
#include <numbers>
#include <vector>

#include "pliant/core/expects.hpp"
#include "pliant/plate/domain_operator.hpp"

namespace pliant {

SparseMatrix assemble_upper(const PlateSystem& system) {
  if (!system.interior.empty()) return assemble_upper_of_domain(system);
  const Grid& grid = system.grid;
  PLIANT_EXPECTS(grid.columns >= 3 && grid.rows >= 3);
  const int m = grid.columns - 2;  // unknowns along u
  const int n = grid.rows - 2;     // unknowns along v
  // Eq. (4) and (5) gathered by neighbour; the upper triangle has the neighbours with smaller
  // numbers.
  const StencilWeights weights(system);

  SparseMatrix matrix(m * n, m * n);
  matrix.reserve(Eigen::Index{7} * m * n);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < m; ++i) {
      const int column = j * m + i;
      matrix.startVec(column);
      const auto add = [&](int di, int dj, double weight) {
        if (i + di >= 0 && i + di < m && j + dj >= 0) {
          matrix.insertBack(column + dj * m + di, column) = weight;
        }
      };
      add(0, -2, weights.two_v);
      add(-1, -1, weights.corner);
      add(0, -1, weights.beside_v);
      add(1, -1, weights.corner);
      add(-2, 0, weights.two_u);
      add(-1, 0, weights.beside_u);
      // Eq. (7): a ghost mirrors its node with weight +1, so each edge nearby adds its weight once
      // more.
      const int edges_u = (i == 0) + (i == m - 1);
      const int edges_v = (j == 0) + (j == n - 1);
      matrix.insertBack(column, column) =
          weights.centre + edges_u * weights.two_u + edges_v * weights.two_v;
    }
  }
  matrix.finalize();
  return matrix;
}

Field residual(const PlateSystem& system, const Field& w, const Field& f) {
  if (!system.interior.empty()) return residual_of_domain(system, w, f);
  using Real = ExtendedStencil::Real;
  const Grid& grid = system.grid;
  PLIANT_EXPECTS(w.rows() == unknown_count(grid) && f.rows() == unknown_count(grid));
  const int M = grid.columns;
  const ExtendedStencil stencil(system);

  Field result(f.rows(), 3);
  std::vector<Real> nodes(static_cast<std::size_t>(grid.node_count()));  // the rim remains 0
  for (int component = 0; component < 3; ++component) {
    int row = 0;
    for (int j = 1; j < grid.rows - 1; ++j) {
      for (int i = 1; i < M - 1; ++i) nodes[grid.node(i, j)] = w(row++, component);
    }
    row = 0;
    for (int j = 1; j < grid.rows - 1; ++j) {
      for (int i = 1; i < M - 1; ++i, ++row) {
        const Real* const p = &nodes[grid.node(i, j)];
        // Eq. (4) to (7) with slopes 0, as in `apply_stencil`.
        const Real left = i == 1 ? p[0] : p[-2];
        const Real right = i == M - 2 ? p[0] : p[2];
        const Real below = j == 1 ? p[0] : p[-2 * M];
        const Real above = j == grid.rows - 2 ? p[0] : p[2 * M];
        result(row, component) =
            static_cast<double>(f(row, component) - stencil.at(p, left, right, below, above));
      }
    }
  }
  return result;
}

double estimate_condition(const PlateSystem& system) {
  const auto& [b, c, d] = system.stiffness;
  const double width = (system.grid.columns - 1) * system.grid.hu;
  const double depth = (system.grid.rows - 1) * system.grid.hv;
  // (1 -2 1)/h^2 has eigenvalues from about (pi/extent)^2 to 4/h^2.
  const double most_u = 4 / (system.grid.hu * system.grid.hu);
  const double most_v = 4 / (system.grid.hv * system.grid.hv);
  const double least_u = std::numbers::pi * std::numbers::pi / (width * width);
  const double least_v = std::numbers::pi * std::numbers::pi / (depth * depth);
  const double most =
      system.shift + b * most_u * most_u + std::max(c, 0.0) * most_u * most_v + d * most_v * most_v;
  const double least = b * least_u * least_u + c * least_u * least_v + d * least_v * least_v;
  return std::max(1.0, most / (system.shift + least));
}

}  // namespace pliant
