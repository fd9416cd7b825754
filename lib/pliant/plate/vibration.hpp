#pragma once

#include <functional>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/plate/plate_solver.hpp"
#include "pliant/plate/triangles/triangle_plate.hpp"

namespace pliant {

/// A plate that can vibrate: K w = lambda M w, with M a diagonal of masses.
struct VibratingPlate {
  /// Solves K w = f (#unknowns x 3).
  std::function<Result<Field>(const Field& forces)> solve;
  Eigen::VectorXd masses;  ///< #unknowns
  Field shapes;            ///< #unknowns x 3: with a part along each slow vibration, to start with
  RunContext context;      ///< its stop request is called before every pass
};

/// The interior of a clamped plate, rim and tangents 0, with masses of 1. Requires: system.shift is
/// 0; at least one unknown; the solver outlives the result. Errors: those of `prepare`.
Result<VibratingPlate> vibrating(PlateSolver& solver, const PlateSystem& system);

/// A plate of triangles, its held points and slopes at 0. Requires: it has masses, and outlives the
/// result. Errors: those of `prepare`.
Result<VibratingPlate> vibrating(TrianglePlate& plate, const Bending& bending);

/// The smallest eigenvalue lambda of a plate [1/uv^4]: the slowest free vibration of a plate of
/// density rho has the angular frequency sqrt(lambda / rho) [1/s]. By subspace iteration, to 1e-9
/// if the eigenvalues are far apart and to 1e-4 if many are close together, as for a sliver.
/// Errors: those of the solver; Interrupted.
Result<double> smallest_eigenvalue(const VibratingPlate& plate);

/// A vibration of a plate that is released, as seen at one of its nodes.
struct ExcitedMode {
  double lambda = 0;  ///< eigenvalue of L, or of a group of fast modes [1/uv^4]
  double share = 0;   ///< of the node's displacement at release [1]; the shares add up to 1
};

/// The modes of a shape (#unknowns) as seen at unknown `node`, the slowest first: eigenvalues and
/// vectors by Lanczos' method on the inverse of K, started with the shape, so that the slow modes
/// are exact and the fast ones are combined into a few groups; docs/model.md, eq. (41), (42).
/// Source: Wilson, Yuan, Dickens, Dynamic analysis by direct superposition of Ritz vectors (1982).
/// Requires: shape(node) is not 0. Errors: as above. Cost: at most 24 solves.
Result<std::vector<ExcitedMode>> excited_modes(const VibratingPlate& plate,
                                               const Eigen::VectorXd& shape, Eigen::Index node);

}  // namespace pliant
