#pragma once

#include "pliant/plate/operator.hpp"

namespace pliant {

// `assemble_upper` and `residual` of a system that has an interior mask; not for other rooms.

SparseMatrix assemble_upper_of_domain(const PlateSystem& system);
Field residual_of_domain(const PlateSystem& system, const Field& w, const Field& f);

}  // namespace pliant
