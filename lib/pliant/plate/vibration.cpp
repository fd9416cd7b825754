#include "pliant/plate/vibration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "pliant/core/expects.hpp"

namespace pliant {
namespace {

// Shapes that satisfy the clamped rim: a bump, and the bump made odd along u and along v. For any
// symmetry of the slowest vibration, one of them has a component along it.
Field starting_shapes(const PlateSystem& system) {
  const Grid& grid = system.outline.grid();
  Field shapes(grid.node_count(), 3);
  for (int j = 0; j < grid.rows; ++j) {
    const double y = static_cast<double>(j) / (grid.rows - 1);
    for (int i = 0; i < grid.columns; ++i) {
      const double x = static_cast<double>(i) / (grid.columns - 1);
      const double bump = x * (1 - x) * y * (1 - y);
      // A little off the middle, so that no shape is orthogonal to a vibration that it should find.
      shapes.row(grid.node(i, j)) << bump, bump * (x - 0.49), bump * (y - 0.51);
    }
  }
  return interior_of(system.outline, shapes);
}

// Irregular numbers between -1 and 1, so that each slow vibration has a part in them once they were
// smoothed by a solve.
Field irregular_shapes(Eigen::Index count) {
  constexpr double golden = 0.618033988749895;
  Field shapes(count, 3);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double one = golden * static_cast<double>(k + 1), other = 7 * one;
    shapes.row(k) << 1, 2 * (one - std::floor(one)) - 1, 2 * (other - std::floor(other)) - 1;
  }
  return shapes;
}

Field times_masses(const VibratingPlate& plate, const Field& w) {
  return w.array().colwise() * plate.masses.array();
}

}  // namespace

Result<VibratingPlate> vibrating(PlateSolver& solver, const PlateSystem& system) {
  PLIANT_EXPECTS(system.shift == 0 && unknown_count(system.outline) >= 1);
  if (auto ready = solver.prepare(system); !ready) return fail(ready.error());
  return VibratingPlate{[&solver](const Field& forces) { return solver.solve(forces); },
                        Eigen::VectorXd::Ones(unknown_count(system.outline)),
                        starting_shapes(system), solver.context()};
}

Result<VibratingPlate> vibrating(TrianglePlate& plate, const Bending& bending) {
  PLIANT_EXPECTS(!plate.masses().empty());
  if (auto ready = plate.prepare(bending, 0); !ready) return fail(ready.error());
  const auto count = static_cast<Eigen::Index>(plate.masses().size());
  return VibratingPlate{[&plate](const Field& forces) { return plate.solve(forces); },
                        Eigen::Map<const Eigen::VectorXd>(plate.masses().data(), count),
                        irregular_shapes(count), plate.context()};
}

Result<double> smallest_eigenvalue(const VibratingPlate& plate) {
  // Inverse iteration on three shapes at once. In their span the eigenvalues mu of the inverse are
  // those of x^T M x = mu x^T K x for the solutions x of K x = M shapes; the largest mu is 1 /
  // lambda.
  Field forces = times_masses(plate, plate.shapes);
  double lambda = std::numeric_limits<double>::infinity();
  constexpr int most_passes = 500;
  for (int pass = 0; pass < most_passes; ++pass) {
    if (plate.context.is_stopped()) return fail(ErrorCode::Interrupted, "interrupted");
    auto solutions = plate.solve(forces);
    if (!solutions) return fail(solutions.error());
    if (forces.rows() == 1) return forces(0, 0) / ((*solutions)(0, 0) * plate.masses(0));
    const Eigen::Matrix3d energy = solutions->transpose() * forces;  // x^T K x
    const Eigen::Matrix3d mass = solutions->transpose() * times_masses(plate, *solutions);
    // With fewer than three unknowns the shapes are dependent; the diagonal is then shifted by a
    // negligible amount.
    const double shift = 1e-14 * energy.trace();
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix3d> modes(
        mass, 0.5 * (energy + energy.transpose()) + shift * Eigen::Matrix3d::Identity());
    const double next = 1 / modes.eigenvalues()(2);
    const bool is_settled = std::abs(lambda - next) <= 1e-10 * next;
    lambda = next;
    if (is_settled) break;
    Field shapes = *solutions * modes.eigenvectors();
    for (int k = 0; k < 3; ++k) shapes.col(k) /= shapes.col(k).norm();
    forces = times_masses(plate, shapes);
  }
  return lambda;
}

Result<std::vector<ExcitedMode>> excited_modes(const VibratingPlate& plate,
                                               const Eigen::VectorXd& shape, Eigen::Index node) {
  PLIANT_EXPECTS(shape.size() == plate.masses.size() && shape(node) != 0);
  // Lengths and angles are those of M.
  const auto dot = [&](const auto& a, const auto& b) -> double {
    return a.dot(plate.masses.cwiseProduct(b));
  };
  // Q^T M inverse(K) M Q = T is tridiagonal; the first column of Q is the shape's direction. Each
  // new direction is orthogonalised twice against all before it, so that rounding does not bring
  // one back.
  constexpr Eigen::Index most = 24;
  const Eigen::Index size = std::min<Eigen::Index>(most, shape.size());
  Eigen::MatrixXd basis(shape.size(), size);
  Eigen::MatrixXd projected = Eigen::MatrixXd::Zero(size, size);
  const double length = std::sqrt(dot(shape, shape));
  basis.col(0) = shape / length;
  Eigen::Index count = 1;
  for (;; ++count) {
    if (plate.context.is_stopped()) return fail(ErrorCode::Interrupted, "interrupted");
    Field right_hand_side = Field::Zero(shape.size(), 3);
    right_hand_side.col(0) = plate.masses.cwiseProduct(basis.col(count - 1));
    auto solved = plate.solve(right_hand_side);
    if (!solved) return fail(solved.error());
    Eigen::VectorXd next = solved->col(0);
    projected(count - 1, count - 1) = dot(basis.col(count - 1), next);
    const auto known = basis.leftCols(count);
    for (int pass = 0; pass < 2; ++pass)
      next -= known * (known.transpose() * plate.masses.cwiseProduct(next)).eval();
    const double rest = std::sqrt(dot(next, next));
    // The shape is a sum of a few modes, and all are found.
    if (count == size || rest <= 1e-12 * projected(0, 0)) break;
    projected(count, count - 1) = projected(count - 1, count) = rest;
    basis.col(count) = next / rest;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(projected.topLeftCorner(count, count));
  std::vector<ExcitedMode> excited;
  for (Eigen::Index k = count - 1; k >= 0; --k) {
    const double inverse = modes.eigenvalues()(k);
    if (!(inverse > 0)) continue;  // rounding error of a very fast mode
    const double at_node = basis.row(node).head(count).dot(modes.eigenvectors().col(k));
    excited.push_back({1 / inverse, length * at_node * modes.eigenvectors()(0, k) / shape(node)});
  }
  return excited;
}

}  // namespace pliant
