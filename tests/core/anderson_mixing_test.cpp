#include "pliant/core/anderson_mixing.hpp"

#include <Eigen/Dense>

#include "support/catch.hpp"

using namespace pliant;

namespace {

using Numbers = std::vector<double>;

// x -> A x + b, and the point that it leaves where it is.
struct LinearMap {
  Eigen::MatrixXd A;
  Eigen::VectorXd b;

  Numbers image(const Numbers& x) const {
    const Eigen::VectorXd y =
        A * Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size())) + b;
    return {y.begin(), y.end()};
  }
  // How far x is from the fixed point.
  double error(const Numbers& x) const {
    const auto n = static_cast<Eigen::Index>(x.size());
    const Eigen::VectorXd fixed = (Eigen::MatrixXd::Identity(n, n) - A).partialPivLu().solve(b);
    return (Eigen::Map<const Eigen::VectorXd>(x.data(), n) - fixed).norm() / fixed.norm();
  }
};

// `size` is the largest number of A's rows in sum: below 1 each round comes closer.
LinearMap random_map(int n, double size) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Random(n, n);
  A *= size / A.cwiseAbs().rowwise().sum().maxCoeff();
  return {A, Eigen::VectorXd::Random(n)};
}

}  // namespace

TEST_CASE("on a linear map of n numbers the fixed point is found in n + 1 rounds",
          "[core][mixing]") {
  for (const int n : {1, 2, 5, 11}) {
    // Going round would never come there with a size of 4.
    for (const double size : {0.9, 4.0}) {
      CAPTURE(n, size);
      const LinearMap map = random_map(n, size);
      AndersonMixing mixing(20);
      Numbers x(static_cast<std::size_t>(n), 0);
      for (int round = 0; round <= n; ++round) x = mixing.next(x, map.image(x));
      CHECK(map.error(x) < 1e-8);
    }
  }
}

TEST_CASE("a short memory still comes closer than going round", "[core][mixing]") {
  LinearMap map = random_map(30, 1);
  map.A = Eigen::VectorXd::LinSpaced(30, 0.1, 0.98).asDiagonal();
  AndersonMixing mixing(3);
  Numbers x(30, 0), plain = x;
  for (int round = 0; round < 25; ++round) {
    x = mixing.next(x, map.image(x));
    plain = map.image(plain);
  }
  CHECK(map.error(x) < 0.5 * map.error(plain));
}

TEST_CASE("without a past the next point is the image", "[core][mixing]") {
  const LinearMap map = random_map(4, 0.5);
  AndersonMixing mixing(5);
  const Numbers x = {1, -2, 3, 0.5}, image = map.image(x);
  CHECK(mixing.next(x, image) == image);
  CHECK(mixing.next(image, map.image(image)) != map.image(image));
  mixing.clear();
  CHECK(mixing.next(x, image) == image);
}

TEST_CASE("what says nothing new is no direction", "[core][mixing]") {
  AndersonMixing mixing(5);
  const Numbers x = {1, 2}, image = {3, 1};
  // The same point again, and a residual that is 0.
  CHECK(mixing.next(x, image) == image);
  CHECK(mixing.next(x, image) == image);
  CHECK(mixing.next(image, image) == image);
  CHECK(mixing.next(image, image) == image);
}
