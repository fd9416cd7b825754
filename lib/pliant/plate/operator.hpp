#pragma once

#include <Eigen/SparseCore>

#include "pliant/plate/outline.hpp"
#include "pliant/plate/plate.hpp"

namespace pliant {

/// The system that a step solves: (shift I + L) w = f on the interior nodes of a clamped plate,
/// where L is `apply_stencil` with rim and tangents 0. Symmetric, and positive definite when the
/// stiffness is elliptic and shift >= 0. docs/model.md, eq. (8).
struct PlateSystem {
  Outline outline;      ///< of at least 3 x 3 nodes
  Stiffness stiffness;  ///< elliptic
  double shift = 0;     ///< rho/dt^2 + eta/dt, >= 0 [1/uv^4]

  friend bool operator==(const PlateSystem&, const PlateSystem&) = default;
};

using SparseMatrix = Eigen::SparseMatrix<double>;

/// The upper triangle of the system's matrix (#unknowns x #unknowns), by columns, rows ascending.
/// Its pattern depends only on the outline's nodes: entries that happen to be 0 are kept.
SparseMatrix assemble_upper(const PlateSystem& system);

/// f - (shift I + L) w (#unknowns x 3), with coefficients and sums in extended precision (64 bits
/// of mantissa on x86-64), for iterative refinement: in plain double its rounding error would be as
/// large as the residual itself.
Field residual(const PlateSystem& system, const Field& w, const Field& f);

/// An estimate of the condition number of the system's matrix: an upper bound of its eigenvalues
/// divided by the smallest eigenvalue of the whole rectangle, simply supported. At least 1.
double estimate_condition(const PlateSystem& system);

}  // namespace pliant
