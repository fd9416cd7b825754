#pragma once

#include "pliant/plate/plate_problem.hpp"
#include "pliant/plate/sparse/sparse_factor.hpp"

namespace pliant {

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
