#include "pliant/plate/vibration.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "pliant/core/expects.hpp"

namespace pliant {
namespace {

// Shapes that meet the clamped rim: a bump, and the bump odd along u and along v. Whatever the
// symmetry of the slowest vibration, one of them has a part in it.
Field starting_shapes(const Grid& grid) {
  Field shapes(unknown_count(grid), 3);
  Eigen::Index row = 0;
  for (int j = 1; j < grid.rows - 1; ++j) {
    const double y = static_cast<double>(j) / (grid.rows - 1);
    for (int i = 1; i < grid.columns - 1; ++i, ++row) {
      const double x = static_cast<double>(i) / (grid.columns - 1);
      const double bump = x * (1 - x) * y * (1 - y);
      // A little off the middle, so that no shape is orthogonal to one that it should find.
      shapes.row(row) << bump, bump * (x - 0.49), bump * (y - 0.51);
    }
  }
  return shapes;
}

}  // namespace

Result<double> smallest_eigenvalue(LinearSolver& solver, const Grid& grid,
                                   const Stiffness& stiffness, const StopRequest& should_stop) {
  PLIANT_EXPECTS(grid.columns >= 3 && grid.rows >= 3);
  if (auto factored = solver.factor({grid, stiffness, 0}); !factored) return fail(factored.error());

  // Inverse iteration on three shapes at once. In their span the eigenvalues mu of the inverse are
  // those of x^T x = mu x^T (L x) for the solutions x of L x = shapes; the largest mu is 1 /
  // lambda.
  Field shapes = starting_shapes(grid);
  double lambda = std::numeric_limits<double>::infinity();
  constexpr int most_passes = 500;
  for (int pass = 0; pass < most_passes; ++pass) {
    if (should_stop && should_stop()) return fail(ErrorCode::Interrupted, "interrupted");
    auto solutions = solver.solve(shapes);
    if (!solutions) return fail(solutions.error());
    if (grid.node_count() == 9) return shapes(0, 0) / (*solutions)(0, 0);  // one unknown
    const Eigen::Matrix3d energy = solutions->transpose() * shapes;        // x^T L x
    const Eigen::Matrix3d mass = solutions->transpose() * *solutions;
    // Fewer than three unknowns leave the shapes dependent; the diagonal is then shifted by less
    // than what counts.
    const double shift = 1e-14 * energy.trace();
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix3d> modes(
        mass, 0.5 * (energy + energy.transpose()) + shift * Eigen::Matrix3d::Identity());
    const double next = 1 / modes.eigenvalues()(2);
    const bool is_settled = std::abs(lambda - next) <= 1e-10 * next;
    lambda = next;
    if (is_settled) break;
    shapes = *solutions * modes.eigenvectors();
    for (int k = 0; k < 3; ++k) shapes.col(k) /= shapes.col(k).norm();
  }
  return lambda;
}

}  // namespace pliant
