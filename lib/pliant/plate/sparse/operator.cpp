#include "pliant/plate/sparse/operator.hpp"

#include <algorithm>
#include <numbers>
#include <vector>

#include "pliant/core/expects.hpp"
#include "pliant/plate/stencil.hpp"

namespace pliant {

SparseMatrix assemble_upper(const PlateSystem& system) {
  const Outline& outline = system.outline;
  const Grid& grid = outline.grid();
  PLIANT_EXPECTS(grid.columns >= 3 && grid.rows >= 3);
  const int M = grid.columns;
  const StencilWeights weights(grid, system.stiffness, system.shift);

  // The number of each interior node among the unknowns, -1 for the others.
  std::vector<int> numbers(static_cast<std::size_t>(grid.node_count()), -1);
  int next = 0;
  outline.for_each_run([&](const Outline::Run& run) {
    for (int i = run.i0; i <= run.i1; ++i) numbers[grid.node(i, run.j)] = next++;
  });
  SparseMatrix matrix(next, next);
  matrix.reserve(Eigen::Index{7} * next);
  outline.for_each_run([&](const Outline::Run& run) {
    for (int i = run.i0; i <= run.i1; ++i) {
      const int* const number = &numbers[grid.node(i, run.j)];
      const int column = number[0];
      matrix.startVec(column);
      const auto add = [&](int offset, double weight) {
        if (number[offset] >= 0) matrix.insertBack(number[offset], column) = weight;
      };
      // The upper triangle has the neighbours with smaller numbers. Eq. (13): a node two steps away
      // counts unless the one between is rim.
      if (number[-M] >= 0) add(-2 * M, weights.two_v);
      add(-M - 1, weights.corner);
      add(-M, weights.beside_v);
      add(-M + 1, weights.corner);
      if (number[-1] >= 0) add(-2, weights.two_u);
      add(-1, weights.beside_u);
      // Eq. (7): beside a rim node, the ghost behind it adds its weight to the node it mirrors.
      const int ghosts_u = (number[-1] < 0) + (number[1] < 0);
      const int ghosts_v = (number[-M] < 0) + (number[M] < 0);
      matrix.insertBack(column, column) =
          weights.centre + ghosts_u * weights.two_u + ghosts_v * weights.two_v;
    }
  });
  matrix.finalize();
  return matrix;
}

Field residual(const PlateSystem& system, const Field& w, const Field& f) {
  using Real = long double;
  const Outline& outline = system.outline;
  const Grid& grid = outline.grid();
  PLIANT_EXPECTS(w.rows() == outline.unknown_count() && f.rows() == w.rows());
  const Stencil<Real> stencil(grid, system.stiffness);

  Field result(f.rows(), 3);
  std::vector<Real> nodes(static_cast<std::size_t>(grid.node_count()));  // the rim remains 0
  for (int component = 0; component < 3; ++component) {
    int row = 0;
    outline.for_each_run([&](const Outline::Run& run) {
      for (int i = run.i0; i <= run.i1; ++i) nodes[grid.node(i, run.j)] = w(row++, component);
    });
    row = 0;
    outline.for_each_run([&](const Outline::Run& run) {
      for (int i = run.i0; i <= run.i1; ++i, ++row) {
        const Real* const p = &nodes[grid.node(i, run.j)];
        const auto near = [&](int di, int dj) { return p[grid.node(di, dj)]; };
        const auto far = [&](int di, int dj) {
          return is_ghost(outline, i, run.j, di, dj) ? p[0] : near(di, dj);
        };
        const Real product = stencil.apply(system.shift, near, far);
        result(row, component) = static_cast<double>(f(row, component) - product);
      }
    });
  }
  return result;
}

double estimate_condition(const PlateSystem& system) {
  const auto& [b, c, d] = system.stiffness;
  const Grid& grid = system.outline.grid();
  const double width = (grid.columns - 1) * grid.hu;
  const double depth = (grid.rows - 1) * grid.hv;
  // (1 -2 1)/h^2 has eigenvalues from about (pi/extent)^2 to 4/h^2.
  const double most_u = 4 / (grid.hu * grid.hu);
  const double most_v = 4 / (grid.hv * grid.hv);
  const double least_u = std::numbers::pi * std::numbers::pi / (width * width);
  const double least_v = std::numbers::pi * std::numbers::pi / (depth * depth);
  const double most =
      system.shift + b * most_u * most_u + std::max(c, 0.0) * most_u * most_v + d * most_v * most_v;
  const double least = b * least_u * least_u + c * least_u * least_v + d * least_v * least_v;
  return std::max(1.0, most / (system.shift + least));
}

}  // namespace pliant
