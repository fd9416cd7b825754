#pragma once

#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/plate/plate_solver.hpp"

namespace pliant {

/// The smallest eigenvalue lambda of L on the interior of a clamped plate, rim and tangents 0
/// [1/uv^4]: the slowest free vibration of a plate of density rho has the angular frequency
/// sqrt(lambda / rho) [1/s]. By subspace iteration, to 1e-9 if the eigenvalues are far apart and to
/// 1e-4 if many are close together, as for a sliver. The stop request of the solver's context is
/// called before every pass. Requires: system.shift is 0; at least one unknown. Errors: those of
/// the solver; Interrupted.
Result<double> smallest_eigenvalue(PlateSolver& solver, const PlateSystem& system);

/// A vibration of a plate that is released, as seen at one of its nodes.
struct ExcitedMode {
  double lambda = 0;  ///< eigenvalue of L, or of a group of fast modes [1/uv^4]
  double share = 0;   ///< of the node's displacement at release [1]; the shares add up to 1
};

/// The modes of a shape (#unknowns) as seen at unknown `node`, the slowest first: eigenvalues and
/// vectors by Lanczos' method on the inverse of L, started with the shape, so that the slow modes
/// are exact and the fast ones are combined into a few groups; docs/model.md, eq. (41), (42).
/// Source: Wilson, Yuan, Dickens, Dynamic analysis by direct superposition of Ritz vectors (1982).
/// Requires: as above, and shape(node) is not 0. Errors: as above. Cost: at most 24 solves.
Result<std::vector<ExcitedMode>> excited_modes(PlateSolver& solver, const PlateSystem& system,
                                               const Eigen::VectorXd& shape, Eigen::Index node);

}  // namespace pliant
