#pragma once

#include <functional>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/plate/plate_solver.hpp"
#include "pliant/plate/triangles/triangle_plate.hpp"

namespace pliant {

/// A plate that can vibrate: K w = lambda M w, with M a diagonal of masses.
struct VibratingPlate {
  using Solve = std::function<Result<Field>(const Field& forces)>;

  Solve solve;             ///< of (K + shift M) w = f (#unknowns x 3)
  Eigen::VectorXd masses;  ///< #unknowns, > 0
  Field shapes;            ///< #unknowns x 3: with a part along each slow vibration, to start with
  RunContext context;      ///< its stop request is called before every pass
  double shift = 0;        ///< >= 0; > 0 if nothing holds the plate [1/uv^4]
  /// The same as `solve`, but that rounding is never corrected; empty: `solve` is as quick.
  Solve rough = {};
  /// #unknowns x up to 3: motions K w = 0 that are known.
  Eigen::MatrixXd rigid = {};
  /// Makes the upper triangle of K, and `solver` is by whose factor it is solved: a plate of equal
  /// ones has the same slowest vibration to the bit. Empty: it is not known.
  std::function<Result<SparseMatrix>()> matrix = {};
  SolverChoice solver = SolverChoice::Auto;
  /// Makes a solve for another shift, perhaps in place of `solve`: for a shift < 0 too, if K +
  /// shift M is positive definite. Errors: SolverFailed if it is not. Empty: none is made.
  std::function<Result<Solve>(double shift)> shifted = {};

  Result<Field> solve_roughly(const Field& forces) const { return (rough ? rough : solve)(forces); }
};

/// Whether a static plate has a solution: the edges hold it, or those motions that they leave and
/// that bend nothing move a node that a goal pulls back.
bool is_held(const PlateSystem& system);

/// The unknowns of a plate, rim and tangents 0, with the nodes' shares of area as masses, times the
/// factors of a map of density. Requires: system.shift is 0, or > 0 if nothing holds the plate; at
/// least one unknown; the solver outlives the result. Errors: those of `prepare`.
Result<VibratingPlate> vibrating(PlateSolver& solver, const PlateSystem& system);

/// A plate of triangles, its held points and slopes at 0. Requires: it has masses, and outlives the
/// result; shift > 0 if nothing holds it, nor a goal. Errors: those of `prepare`.
Result<VibratingPlate> vibrating(TrianglePlate& plate, const Bending& bending, double shift = 0,
                                 double goal = 0);

/// The smallest eigenvalue lambda of a plate that is not that of a rigid motion [1/uv^4]: the
/// slowest free vibration of a plate of density rho has the angular frequency sqrt(lambda / rho)
/// [1/s]. 0 if every motion is rigid. Right to 1e-7, usually to 1e-9, with the same bits
/// everywhere; docs/model.md, eq. (42b). Errors: those of the solver; SolverFailed if it is not
/// found; OutOfMemory; Interrupted. Afterwards a `shifted` plate may no longer solve. That of a
/// plate whose matrix is known is kept on the shelf, if there is one. Source: Wu, Simon,
/// Thick-restart Lanczos method for large symmetric eigenvalue problems (2000).
Result<double> smallest_eigenvalue(const VibratingPlate& plate);

/// The same of a plate of a grid, whose shift is not read. Prepares the solver.
Result<double> smallest_eigenvalue(PlateSolver& solver, PlateSystem system);

/// The same of a plate of triangles; `is_held`: whether anything holds it, or its goal does.
Result<double> smallest_eigenvalue(TrianglePlate& plate, const Bending& bending, bool is_held,
                                   double goal = 0);

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

/// The same from the inverse of K in the space of Lanczos' vectors, of which the first one has the
/// direction of the shape, and what they are at the node. Requires: at_node(0) is not 0.
std::vector<ExcitedMode> excited_modes(const Eigen::MatrixXd& projected,
                                       const Eigen::RowVectorXd& at_node);

/// Lanczos' vectors for the modes of a shape.
inline constexpr Eigen::Index most_excited = 24;

}  // namespace pliant
