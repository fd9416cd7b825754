#pragma once

#include <Eigen/Core>

namespace pliant::testing {

// Slow independent ways, by Eigen. Compiled once, since each file that asks Eigen for them takes
// the compiler seconds.

/// The vibrations of a matrix, the slowest first.
struct Modes {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;  ///< one column each
};

/// Those of a symmetric matrix.
Modes modes_of(const Eigen::MatrixXd& matrix);

/// The same with masses, a positive definite matrix: `K x = value M x`.
Modes modes_of(const Eigen::MatrixXd& stiffness, const Eigen::MatrixXd& masses);

/// The eigenvalues of a symmetric matrix, ascending.
Eigen::VectorXd eigenvalues_of(const Eigen::MatrixXd& matrix);

/// e^A by scaling and squaring.
Eigen::MatrixXd exponential_of(const Eigen::MatrixXd& A);

}  // namespace pliant::testing
