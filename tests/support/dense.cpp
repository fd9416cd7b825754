#include "support/dense.hpp"

#include <Eigen/Eigenvalues>
#include <unsupported/Eigen/MatrixFunctions>

namespace pliant::testing {

Modes modes_of(const Eigen::MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> all(matrix);
  return {all.eigenvalues(), all.eigenvectors()};
}

Modes modes_of(const Eigen::MatrixXd& stiffness, const Eigen::MatrixXd& masses) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> all(stiffness, masses);
  return {all.eigenvalues(), all.eigenvectors()};
}

Eigen::VectorXd eigenvalues_of(const Eigen::MatrixXd& matrix) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly)
      .eigenvalues();
}

Eigen::MatrixXd exponential_of(const Eigen::MatrixXd& A) { return A.exp(); }

}  // namespace pliant::testing
