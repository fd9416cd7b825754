#pragma once

#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/plate/linear_solver.hpp"
#include "pliant/plate/plate.hpp"

namespace pliant {

/// The smallest eigenvalue lambda of L on the interior of a clamped plate, rim and tangents 0
/// [1/uv^4]: the slowest free vibration of a plate of density rho has the angular frequency
/// sqrt(lambda / rho) [1/s]. By subspace iteration, to 1e-9 where the eigenvalues lie apart and to
/// 1e-4 where many lie close together, as those of a sliver do. Requires: system.shift is 0; at
/// least one unknown. Errors: those of the solver; Interrupted when `should_stop`, asked ahead of
/// every pass, says so.
Result<double> smallest_eigenvalue(LinearSolver& solver, const PlateSystem& system,
                                   const StopRequest& should_stop = {});

/// A vibration that a plate falls into when it is let go, as one of its nodes shows it.
struct ExcitedMode {
  double lambda = 0;  ///< eigenvalue of L, or of a bundle of fast ones [1/uv^4]
  double share = 0;   ///< of the node's displacement when it is let go [1]; all add up to 1
};

/// What a shape (#unknowns) falls apart into at unknown `node`, the slowest mode first: eigenvalues
/// and vectors by Lanczos' method on the inverse of L, begun with the shape, so that the slow ones
/// are exact and the fast ones come in a few bundles;
/// docs/model.md, eq. (41), (42). Source: Wilson, Yuan, Dickens, Dynamic
/// analysis by direct superposition of Ritz vectors (1982). Requires: as above, and shape(node) is
/// not 0. Errors: as above. Cost: at most 24 solves.
Result<std::vector<ExcitedMode>> excited_modes(LinearSolver& solver, const PlateSystem& system,
                                               const Eigen::VectorXd& shape, Eigen::Index node,
                                               const StopRequest& should_stop = {});

}  // namespace pliant
