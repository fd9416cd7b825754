#pragma once

#include <memory>

#include "pliant/plate/plate_solver.hpp"

namespace pliant {

// The implementations behind `make_plate_solver`. Internal to plate.

/// For all plates. Factors a sparse matrix, by the factor of `choice`. Requires: it is available.
std::unique_ptr<PlateSolver> make_sparse_solver(SolverChoice choice = available_solvers().front(),
                                                const RunContext& context = {});

/// For rectangles, clamped or pinned.
std::unique_ptr<PlateSolver> make_spectral_solver(const RunContext& context);

}  // namespace pliant
