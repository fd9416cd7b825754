#include "pliant/plate/sparse/operator.hpp"

#include <algorithm>
#include <numbers>
#include <vector>

#include "pliant/core/expects.hpp"
#include "pliant/plate/sparse/upper_column.hpp"
#include "pliant/plate/stencil.hpp"

namespace pliant {
SparseMatrix assemble_upper(const PlateSystem& system) {
  const Outline& outline = system.outline;
  const Grid& grid = outline.grid();
  PLIANT_EXPECTS(grid.columns >= 3 && grid.rows >= 3);
  const StencilWeights weights(grid, system.stiffness, system.shift);

  const std::vector<int> numbers = numbers_of_unknowns(outline);
  const int size = outline.unknown_count();
  SparseMatrix matrix(size, size);
  matrix.reserve(Eigen::Index{7} * size);
  with_steps(outline, [&](const auto& steps_at) {
    outline.for_each_run([&](const Outline::Run& run) {
      for (int i = run.i0; i <= run.i1; ++i) {
        const auto steps = steps_at(i, run.j);
        const int* const numbers_here = &numbers[grid.node(i, run.j)];
        const auto number = [&](int di, int dj) { return numbers_here[steps.to(di, dj)]; };
        const int column = number(0, 0);
        UpperColumn entries;
        // The upper triangle has the neighbours with smaller numbers: in an open grid those before
        // the node, which come first here and in this order.
        const auto add = [&](int di, int dj, double weight) {
          const int row = number(di, dj);
          if (row >= 0 && row <= column) entries.add(row, weight);
        };
        const auto add_row = [&](int dj) {
          add(-1, dj, weights.corner);
          add(0, dj, weights.beside_v);
          add(1, dj, weights.corner);
        };
        // Eq. (13): a node two steps away counts unless the one between is rim.
        if (number(0, -1) >= 0) add(0, -2, weights.two_v);
        add_row(-1);
        if (number(-1, 0) >= 0) add(-2, 0, weights.two_u);
        add(-1, 0, weights.beside_u);
        // Eq. (7): beside a rim node, the ghost behind it adds its weight to the node it mirrors.
        const int ghosts_u = (number(-1, 0) < 0) + (number(1, 0) < 0);
        const int ghosts_v = (number(0, -1) < 0) + (number(0, 1) < 0);
        add(0, 0, weights.centre + ghosts_u * weights.two_u + ghosts_v * weights.two_v);
        if (outline.is_periodic()) {
          add(1, 0, weights.beside_u);
          if (number(1, 0) >= 0) add(2, 0, weights.two_u);
          add_row(1);
          if (number(0, 1) >= 0) add(0, 2, weights.two_v);
        }
        entries.insert_into(matrix, column);
      }
    });
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
  with_steps(outline, [&](const auto& steps_at) {
    for (int component = 0; component < 3; ++component) {
      int row = 0;
      outline.for_each_run([&](const Outline::Run& run) {
        for (int i = run.i0; i <= run.i1; ++i) nodes[grid.node(i, run.j)] = w(row++, component);
      });
      row = 0;
      outline.for_each_run([&](const Outline::Run& run) {
        for (int i = run.i0; i <= run.i1; ++i, ++row) {
          const auto steps = steps_at(i, run.j);
          const Real* const p = &nodes[grid.node(i, run.j)];
          const auto near = [&](int di, int dj) { return p[steps.to(di, dj)]; };
          const auto far = [&](int di, int dj) {
            return is_ghost(outline, i, run.j, di, dj) ? p[0] : near(di, dj);
          };
          const Real product = stencil.apply(system.shift, near, far);
          result(row, component) = static_cast<double>(f(row, component) - product);
        }
      });
    }
  });
  return result;
}

double estimate_condition(const PlateSystem& system) {
  const auto& [b, c, d] = system.stiffness;
  const Grid& grid = system.outline.grid();
  const double width = (grid.columns - 1) * grid.hu;
  const double depth = (grid.rows - 1) * grid.hv;
  // (1 -2 1)/h^2 has eigenvalues from about (pi/extent)^2, round a ring from 0, to 4/h^2.
  const double most_u = 4 / (grid.hu * grid.hu);
  const double most_v = 4 / (grid.hv * grid.hv);
  const double pi_squared = std::numbers::pi * std::numbers::pi;
  const double least_u = grid.is_closed_u ? 0 : pi_squared / (width * width);
  const double least_v = grid.is_closed_v ? 0 : pi_squared / (depth * depth);
  const double most =
      system.shift + b * most_u * most_u + std::max(c, 0.0) * most_u * most_v + d * most_v * most_v;
  const double least = b * least_u * least_u + c * least_u * least_v + d * least_v * least_v;
  return std::max(1.0, most / (system.shift + least));
}

}  // namespace pliant
