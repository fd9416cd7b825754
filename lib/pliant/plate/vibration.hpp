#pragma once

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/plate/linear_solver.hpp"
#include "pliant/plate/plate.hpp"

namespace pliant {

/// The smallest eigenvalue lambda of L on the interior of a clamped rectangle, rim and tangents 0
/// [1/uv^4]: the slowest free vibration of a plate of density rho has the angular frequency
/// sqrt(lambda / rho) [1/s]. By subspace iteration, to 1e-9 where the eigenvalues lie apart and to
/// 1e-4 where many lie close together, as those of a sliver do. Requires: at least 3 x 3 nodes.
/// Errors: those of the solver; Interrupted when `should_stop`, asked ahead of every pass, says so.
Result<double> smallest_eigenvalue(LinearSolver& solver, const Grid& grid,
                                   const Stiffness& stiffness, const StopRequest& should_stop = {});

}  // namespace pliant
