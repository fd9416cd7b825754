#pragma once

#include <functional>

#include <Eigen/Dense>

#include "pliant/plate/outline/outline.hpp"
#include "pliant/plate/plate.hpp"
#include "pliant/plate/sparse/operator.hpp"
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

inline PlateState random_state(const Grid& grid) {
  return {Field::Random(grid.node_count(), 3), Field::Random(grid.node_count(), 3)};
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
