#include "pliant/forces/force.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Geometry>

#include "support/catch.hpp"

using namespace pliant;
using pliant::testing::WithinAbs;

namespace {

class RandomVectors {
 public:
  Vector3d operator()(double extent = 3) {
    std::uniform_real_distribution<double> coordinate(-extent, extent);
    const double x = coordinate(random_), y = coordinate(random_), z = coordinate(random_);
    return {x, y, z};
  }

 private:
  std::mt19937 random_{3};
};

// The segment's closest point by a search that knows no formula.
double searched_distance(const LineForce& line, const Vector3d& p) {
  double low = 0, high = 1;
  const auto at = [&](double t) { return (p - (line.from + t * (line.to - line.from))).norm(); };
  for (int k = 0; k < 200; ++k) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    (at(a) < at(b) ? high : low) = at(a) < at(b) ? b : a;
  }
  return at((low + high) / 2);
}

std::vector<ForceShape> shapes(RandomVectors& vector) {
  return {PointForce{vector(), vector()}, RadialForce{vector()}, LineForce{vector(), vector(), {}},
          LineForce{vector(), vector(), vector()}};
}

// The same shape moved by a rotation and a translation.
struct Move {
  Eigen::Matrix3d rotation;
  Vector3d translation;
  Vector3d point(const Vector3d& p) const { return rotation * p + translation; }
  ForceShape operator()(const PointForce& f) const {
    return PointForce{point(f.center), rotation * f.direction};
  }
  ForceShape operator()(const RadialForce& f) const { return RadialForce{point(f.center)}; }
  ForceShape operator()(const LineForce& f) const {
    LineForce moved{point(f.from), point(f.to), {}};
    if (f.direction) moved.direction = rotation * *f.direction;
    return moved;
  }
};

}  // namespace

TEST_CASE("distances are those to the centre or to the segment", "[forces]") {
  RandomVectors vector;
  for (int trial = 0; trial < 200; ++trial) {
    const Vector3d p = vector(), a = vector(), b = vector();
    CHECK_THAT(distance(PointForce{a, b}, p), WithinAbs((p - a).norm(), 1e-15 * 20));
    CHECK_THAT(distance(RadialForce{a}, p), WithinAbs((p - a).norm(), 1e-15 * 20));
    // The search stops where the distance is flat: sqrt(eps) along the segment, eps in distance.
    const LineForce line{a, b, {}};
    CHECK_THAT(distance(line, p), WithinAbs(searched_distance(line, p), 1e-13));
  }
}

TEST_CASE("a segment of no length is a point", "[forces]") {
  const Vector3d a(1, 2, 3), p(4, 6, 3);
  CHECK(distance(LineForce{a, a, {}}, p) == 5);
  CHECK((direction(LineForce{a, a, {}}, p) - Vector3d(0.6, 0.8, 0)).norm() < 1e-15);
}

TEST_CASE("directions are unit vectors or zero", "[forces]") {
  RandomVectors vector;
  for (int trial = 0; trial < 100; ++trial) {
    const Vector3d p = vector();
    for (const ForceShape& shape : shapes(vector)) {
      CHECK_THAT(direction(shape, p).norm(), WithinAbs(1, 1e-15));
    }
  }
  CHECK(direction(PointForce{{0, 0, 0}, {0, 0, 0}}, {1, 0, 0}) == Vector3d::Zero());
  CHECK(direction(RadialForce{{1, 2, 3}}, {1, 2, 3}) == Vector3d::Zero());
}

TEST_CASE("a direction along one axis is an ordinary direction", "[forces]") {
  // The listing of thesis 5.3 zeroes the force when any component of the direction is 0.
  CHECK(direction(PointForce{{0, 0, 0}, {0, 7, 0}}, {1, 1, 1}) == Vector3d(0, 1, 0));
  CHECK(direction(PointForce{{0, 0, 0}, {0, 0, -1e-300}}, {1, 1, 1}) == Vector3d(0, 0, -1));
  CHECK(direction(PointForce{{0, 0, 0}, {1e300, 0, 0}}, {1, 1, 1}) == Vector3d(1, 0, 0));
}

TEST_CASE("a radial force is odd about its centre", "[forces]") {
  RandomVectors vector;
  for (int trial = 0; trial < 50; ++trial) {
    const RadialForce radial{Vector3d::Zero()};
    const Vector3d p = vector();
    CHECK(direction(radial, p) == -direction(radial, -p));
    CHECK(p.dot(direction(radial, p)) > 0);
  }
}

TEST_CASE("a line force without direction pushes away from the segment", "[forces]") {
  RandomVectors vector;
  for (int trial = 0; trial < 100; ++trial) {
    const LineForce line{vector(), vector(), {}};
    const Vector3d p = vector();
    // Its direction is the gradient of the distance.
    const Vector3d n = direction(line, p);
    const double h = 1e-6;
    for (int k = 0; k < 3; ++k) {
      const Vector3d e = h * Vector3d::Unit(k);
      const double slope = (distance(line, p + e) - distance(line, p - e)) / (2 * h);
      CHECK_THAT(n[k], WithinAbs(slope, 1e-8));  // h^2 curvature and eps/h
    }
  }
}

TEST_CASE("a line force without direction is 0 on the segment itself", "[forces]") {
  RandomVectors vector;
  for (int trial = 0; trial < 200; ++trial) {
    const LineForce line{vector(), vector(), {}};
    const double t = trial / 199.0;
    // t from + ... is rounded, so the point lies beside the segment by some ulps.
    CHECK(direction(line, line.from + t * (line.to - line.from)) == Vector3d::Zero());
  }
}

TEST_CASE("forces move with everything else", "[forces]") {
  RandomVectors vector;
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Matrix3d rotation =
        Eigen::AngleAxisd(vector().x(), vector().normalized()).toRotationMatrix();
    const Move move{rotation, vector()};
    const Vector3d p = vector();
    for (const ForceShape& shape : shapes(vector)) {
      const ForceShape moved = std::visit(move, shape);
      CHECK_THAT(distance(moved, move.point(p)), WithinAbs(distance(shape, p), 1e-14));
      CHECK((direction(moved, move.point(p)) - rotation * direction(shape, p)).norm() < 1e-13);
    }
  }
}

TEST_CASE("a force is magnitude times falloff times direction", "[forces]") {
  RandomVectors vector;
  for (const ForceShape& shape : shapes(vector)) {
    const SampledForce force{shape, -3, 1, 2, Falloff::Gaussian};
    const Vector3d p = vector();
    const double s = distance(shape, p) / 2;
    const Vector3d expected = -3 * std::exp(-4.5 * s * s) * direction(shape, p);
    CHECK((force_at(force, p) - expected).norm() < 1e-14);
  }
}
