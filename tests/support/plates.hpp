#pragma once

#include <functional>

#include <Eigen/Dense>

#include "pliant/plate/energy/grid_assembly.hpp"
#include "pliant/plate/outline/outline.hpp"
#include "pliant/plate/plate.hpp"
#include "pliant/plate/sparse/plate_matrix.hpp"
#include "pliant/plate/stencil.hpp"

namespace pliant::testing {

/// An M x N grid over [0,1] x [0,1].
inline Grid unit_grid(int columns, int rows) {
  return {columns, rows, 1.0 / (columns - 1), 1.0 / (rows - 1)};
}

/// f(u,v) at every node, in all three components. `grid` starts at (0,0).
inline Field sampled(const Grid& grid, const std::function<double(double, double)>& f) {
  Field field(grid.node_count(), 3);
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) {
      field.row(grid.node(i, j)).setConstant(f(i * grid.hu, j * grid.hv));
    }
  }
  return field;
}

/// The upper triangle of the matrix that sparse factors solve.
inline SparseMatrix assemble_upper(const PlateSystem& system) {
  const GridAssembly assembly(system);
  PlateMatrix matrix({});
  if (!matrix.assemble(assembly)) return {};
  const PlateWeights weights = assembly.weights();
  return matrix.shifted((system.shift - system.drag) * weights.masses +
                        system.drag * weights.drags);
}

/// What a solution leaves of the right-hand sides, in extended precision (#unknowns x 3).
inline Field residual(const PlateSystem& system, const Field& w, const Field& f) {
  const GridAssembly assembly(system);
  PlateMatrix matrix({});
  if (!matrix.assemble(assembly) || !matrix.open()) return {};
  const PlateWeights weights = assembly.weights();
  return matrix.residual(
      (system.shift - system.drag) * weights.masses + system.drag * weights.drags, w, f);
}

inline PlateState random_state(const Grid& grid) {
  return {Field::Random(grid.node_count(), 3), Field::Random(grid.node_count(), 3)};
}

/// L w at the interior nodes (#unknowns x 3) of a field w on all nodes (#nodes x 3). Ghosts mirror
/// the nodes beside the rim; tangents are those of rim nodes on the grid's outermost rows and
/// columns, and at all other rim nodes the slope is 0. SPEC 4, 5; docs/model.md, eq. (4) to (7),
/// (12). Requires: at least 3 x 3 nodes.
inline Field apply_stencil(const Outline& outline, const Stiffness& stiffness,
                           const EdgeTangents& tangents, const Field& w) {
  const Grid& grid = outline.grid();
  const Stencil<double> stencil(grid, stiffness);
  Field result(outline.unknown_count(), 3);
  with_steps(outline, [&](const auto& steps_at) {
    for (int component = 0; component < 3; ++component) {
      const EdgeGhosts ghosts(grid, tangents, component);
      int row = 0;
      outline.for_each_run([&](const Outline::Run& run) {
        const int j = run.j;
        for (int i = run.i0; i <= run.i1; ++i) {
          const auto steps = steps_at(i, j);
          const double* const p = w.col(component).data() + grid.node(i, j);
          const auto near = [&](int di, int dj) { return p[steps.to(di, dj)]; };
          const auto far = [&](int di, int dj) {
            return is_ghost(outline, i, j, di, dj) ? p[0] + ghosts.at(i + di, j + dj)
                                                   : near(di, dj);
          };
          result(row++, component) = stencil.apply(near, far);
        }
      });
    }
  });
  return result;
}

/// The system's matrix, column by column from the stencil, independent of the assembly.
inline Eigen::MatrixXd dense_operator(const PlateSystem& system) {
  const int n = unknown_count(system.outline);
  Eigen::MatrixXd dense(n, n);
  for (int column = 0; column < n; ++column) {
    Field unit = Field::Zero(n, 3);
    unit(column, 0) = 1;
    const Field nodes =
        with_interior(system.outline, Field::Zero(system.outline.grid().node_count(), 3), unit);
    dense.col(column) = apply_stencil(system.outline, system.stiffness, {}, nodes).col(0);
    dense(column, column) += system.shift;
  }
  return dense;
}

}  // namespace pliant::testing
