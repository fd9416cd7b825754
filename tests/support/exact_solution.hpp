#pragma once

#include <utility>

#include <Eigen/Core>

#include "pliant/core/field.hpp"
#include "support/dense.hpp"

namespace pliant::testing {

/// e^(T A) for M (rho w'' + eta w') + K w = f by scaling and squaring: on (w, v, f, f'), or without
/// inertia on (w, f, f').
class ExactSolution {
 public:
  using Vector = Eigen::VectorXd;

  /// `inertia` and `drag` are M rho and M eta.
  ExactSolution(const Eigen::MatrixXd& stiffness, Vector inertia, Vector drag, double interval)
      : stiffness_(stiffness), drag_(std::move(drag)), interval_(interval), n_(stiffness.rows()) {
    swings_ = inertia.maxCoeff() > 0;
    const Eigen::Index moving = swings_ ? 2 * n_ : n_;
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(moving + 2 * n_, moving + 2 * n_);
    const Vector mass = swings_ ? inertia : drag_;
    const Eigen::MatrixXd inverse = mass.cwiseInverse().asDiagonal();
    A.block(moving - n_, 0, n_, n_) = -inverse * stiffness;
    if (swings_) {
      A.block(0, n_, n_, n_).setIdentity();
      A.block(n_, n_, n_, n_) = -inverse * Eigen::MatrixXd(drag_.asDiagonal());
    }
    A.block(moving - n_, moving, n_, n_) = inverse;
    A.block(moving, moving + n_, n_, n_).setIdentity();
    power_ = exponential_of(interval * A);
  }

  /// Advances w and v (#rows x 3) under a force that changes evenly.
  void advance(const Eigen::MatrixXd& first, const Eigen::MatrixXd& last, Eigen::MatrixXd& w,
               Eigen::MatrixXd& v) const {
    const Eigen::Index moving = swings_ ? 2 * n_ : n_;
    Eigen::MatrixXd x(moving + 2 * n_, 3);
    x.topRows(n_) = w;
    if (swings_) x.middleRows(n_, n_) = v;
    x.middleRows(moving, n_) = first;
    x.bottomRows(n_) = (last - first) / interval_;
    x = power_ * x;
    w = x.topRows(n_);
    v = swings_ ? Eigen::MatrixXd(x.middleRows(n_, n_))
                : Eigen::MatrixXd(drag_.cwiseInverse().asDiagonal() * (last - stiffness_ * w));
  }

 private:
  Eigen::MatrixXd stiffness_, power_;
  Vector drag_;
  double interval_;
  Eigen::Index n_;
  bool swings_;
};

}  // namespace pliant::testing
