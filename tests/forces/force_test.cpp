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

// The segment's closest point by a search, without a formula.
double searched_distance(const LineForce& line, const Vector3d& p) {
  double low = 0, high = 1;
  const auto at = [&](double t) { return (p - (line.from + t * (line.to - line.from))).norm(); };
  for (int k = 0; k < 200; ++k) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    (at(a) < at(b) ? high : low) = at(a) < at(b) ? b : a;
  }
  return at((low + high) / 2);
}

std::vector<ForceKind> shapes(RandomVectors& vector) {
  return {PointForce{vector(), vector()},
          RadialForce{vector()},
          LineForce{vector(), vector(), {}},
          LineForce{vector(), vector(), vector()},
          UniformForce{vector()},
          VortexForce{vector(), vector(), 0}};
}

// The same shape moved by a rotation and a translation.
struct Move {
  Eigen::Matrix3d rotation;
  Vector3d translation;
  Vector3d point(const Vector3d& p) const { return rotation * p + translation; }
  ForceKind operator()(const PointForce& f) const {
    return PointForce{point(f.center), rotation * f.direction};
  }
  ForceKind operator()(const RadialForce& f) const { return RadialForce{point(f.center)}; }
  ForceKind operator()(const LineForce& f) const {
    LineForce moved{point(f.from), point(f.to), {}};
    if (f.direction) moved.direction = rotation * *f.direction;
    return moved;
  }
  ForceKind operator()(const UniformForce& f) const { return UniformForce{rotation * f.direction}; }
  ForceKind operator()(const VortexForce& f) const {
    return VortexForce{point(f.center), rotation * f.axis, f.pull};
  }
  ForceKind operator()(const NoiseForce& f) const {
    return NoiseForce{point(f.center), f.frequency, f.time, f.seed, rotation};
  }
  ForceKind operator()(const InertiaForce& f) const {
    return InertiaForce{rotation * f.linear * rotation.transpose(), point(f.origin),
                        rotation * f.offset};
  }
  ForceKind operator()(const PressureForce& f) const { return PressureForce{point(f.center)}; }
  ForceKind operator()(const SampledCustomForce& f) const {
    const auto back = [*this](const Vector3d& p) -> Vector3d {
      return rotation.transpose() * (p - translation);
    };
    return SampledCustomForce{
        [=](const Vector3d& p) { return distance(f, back(p)); },
        [=, *this](const Vector3d& p) -> Vector3d { return rotation * unit_force(f, back(p)); }};
  }
};

Eigen::Matrix3d random_rotation(RandomVectors& vector) {
  return Eigen::AngleAxisd(vector().x(), vector().normalized()).toRotationMatrix();
}

}  // namespace

TEST_CASE("distances are those to the centre or to the segment", "[forces]") {
  RandomVectors vector;
  for (int trial = 0; trial < 200; ++trial) {
    const Vector3d p = vector(), a = vector(), b = vector();
    CHECK_THAT(distance(PointForce{a, b}, p), WithinAbs((p - a).norm(), 1e-15 * 20));
    CHECK_THAT(distance(RadialForce{a}, p), WithinAbs((p - a).norm(), 1e-15 * 20));
    // The search stops at a flat minimum of the distance: sqrt(eps) along the segment, eps in
    // distance.
    const LineForce line{a, b, {}};
    CHECK_THAT(distance(line, p), WithinAbs(searched_distance(line, p), 1e-13));
  }
}

TEST_CASE("a segment of no length is a point", "[forces]") {
  const Vector3d a(1, 2, 3), p(4, 6, 3);
  CHECK(distance(LineForce{a, a, {}}, p) == 5);
  CHECK((unit_force(LineForce{a, a, {}}, p) - Vector3d(0.6, 0.8, 0)).norm() < 1e-15);
}

TEST_CASE("directions are unit vectors or zero", "[forces]") {
  RandomVectors vector;
  for (int trial = 0; trial < 100; ++trial) {
    const Vector3d p = vector();
    for (const ForceKind& shape : shapes(vector)) {
      CHECK_THAT(unit_force(shape, p).norm(), WithinAbs(1, 1e-15));
    }
  }
  CHECK(unit_force(PointForce{{0, 0, 0}, {0, 0, 0}}, {1, 0, 0}) == Vector3d::Zero());
  CHECK(unit_force(RadialForce{{1, 2, 3}}, {1, 2, 3}) == Vector3d::Zero());
}

TEST_CASE("a direction along one axis is an ordinary direction", "[forces]") {
  // The listing of thesis 5.3 sets the force to 0 if any component of the direction is 0.
  CHECK(unit_force(PointForce{{0, 0, 0}, {0, 7, 0}}, {1, 1, 1}) == Vector3d(0, 1, 0));
  CHECK(unit_force(PointForce{{0, 0, 0}, {0, 0, -1e-300}}, {1, 1, 1}) == Vector3d(0, 0, -1));
  CHECK(unit_force(PointForce{{0, 0, 0}, {1e300, 0, 0}}, {1, 1, 1}) == Vector3d(1, 0, 0));
}

TEST_CASE("a radial force is odd about its centre", "[forces]") {
  RandomVectors vector;
  for (int trial = 0; trial < 50; ++trial) {
    const RadialForce radial{Vector3d::Zero()};
    const Vector3d p = vector();
    CHECK(unit_force(radial, p) == -unit_force(radial, -p));
    CHECK(p.dot(unit_force(radial, p)) > 0);
  }
}

TEST_CASE("a line force without direction pushes away from the segment", "[forces]") {
  RandomVectors vector;
  for (int trial = 0; trial < 100; ++trial) {
    const LineForce line{vector(), vector(), {}};
    const Vector3d p = vector();
    // The unit force is the gradient of the distance.
    const Vector3d n = unit_force(line, p);
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
    // t from + ... is rounded, so the point is some ulps off the segment.
    CHECK(unit_force(line, line.from + t * (line.to - line.from)) == Vector3d::Zero());
  }
}

TEST_CASE("forces move with everything else", "[forces]") {
  RandomVectors vector;
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Matrix3d rotation = random_rotation(vector);
    const Move move{rotation, vector()};
    const Vector3d p = vector();
    std::vector<ForceKind> all = shapes(vector);
    all.push_back(VortexForce{vector(), vector(), vector().x()});
    all.push_back(InertiaForce{Matrix3d::Random(), vector(), vector()});
    all.push_back(SampledCustomForce{
        [](const Vector3d& q) { return std::abs(q.x()); },
        [](const Vector3d& q) { return Vector3d(q.y() * q.y(), 1, q.x() * q.z()); }});
    for (const ForceKind& shape : all) {
      const ForceKind moved = std::visit(move, shape);
      CHECK_THAT(distance(moved, move.point(p)), WithinAbs(distance(shape, p), 1e-14));
      CHECK((unit_force(moved, move.point(p)) - rotation * unit_force(shape, p)).norm() < 1e-12);
    }
  }
}

TEST_CASE("a force is magnitude times falloff times direction", "[forces]") {
  RandomVectors vector;
  for (const ForceKind& shape : shapes(vector)) {
    const SampledForce force{shape, -3, 1, 2, Falloff::Gaussian};
    const Vector3d p = vector();
    const double s = distance(shape, p) / 2;
    const Vector3d expected = -3 * std::exp(-4.5 * s * s) * unit_force(shape, p);
    CHECK((force_at(force, p) - expected).norm() < 1e-14);
  }
}

TEST_CASE("a uniform force is at distance 0 and the same everywhere", "[forces]") {
  RandomVectors vector;
  const UniformForce uniform{vector()};
  for (int trial = 0; trial < 50; ++trial) {
    const Vector3d p = vector(1e6);
    CHECK(distance(uniform, p) == 0);
    CHECK(unit_force(uniform, p) == unit_force(uniform, Vector3d::Zero()));
  }
  CHECK(unit_force(UniformForce{{0, -3, 0}}, {1, 2, 3}) == Vector3d(0, -1, 0));
  CHECK(unit_force(UniformForce{Vector3d::Zero()}, {1, 2, 3}) == Vector3d::Zero());
}

TEST_CASE("a vortex turns about its axis by the right hand", "[forces][vortex]") {
  // About +y through (2, 0, 0): a point on the +x side is pushed towards -z.
  const VortexForce vortex{{2, 0, 0}, {0, 5, 0}, 0};
  CHECK(distance(vortex, {5, 7, 4}) == 5);
  CHECK(unit_force(vortex, {6, -1, 0}) == Vector3d(0, 0, -1));
  CHECK(unit_force(vortex, {2, 3, 1}) == Vector3d(1, 0, 0));
  const VortexForce sink{{2, 0, 0}, {0, 5, 0}, 0.5};
  CHECK(unit_force(sink, {6, -1, 0}) == Vector3d(-0.5, 0, -1));
}

TEST_CASE("a vortex goes along circles, and pull goes straight in", "[forces][vortex]") {
  RandomVectors vector;
  for (int trial = 0; trial < 100; ++trial) {
    const Vector3d center = vector(), axis = vector(), p = vector();
    const double pull = vector().x();
    const VortexForce turning{center, axis, 0}, both{center, axis, pull};
    const Vector3d along = axis.normalized();
    const Vector3d outward = (p - center) - along.dot(p - center) * along;
    const Vector3d circle = along.cross(outward).normalized();
    CHECK_THAT(distance(both, p), WithinAbs(outward.norm(), 1e-14));
    CHECK((unit_force(turning, p) - circle).norm() < 1e-14);
    CHECK((unit_force(both, p) - (circle - pull * outward.normalized())).norm() < 1e-13);
    // Odd about the axis: half a turn reverses the force.
    const Vector3d opposite = p - 2 * outward;
    CHECK((unit_force(both, p) + unit_force(both, opposite)).norm() < 1e-12);
  }
}

TEST_CASE("a vortex is 0 on its axis, and none without one", "[forces][vortex]") {
  RandomVectors vector;
  for (int trial = 0; trial < 100; ++trial) {
    const VortexForce vortex{vector(), vector(), 0.7};
    const Vector3d on_axis = vortex.center + vector().x() * vortex.axis;
    CHECK(unit_force(vortex, on_axis) == Vector3d::Zero());
  }
  const VortexForce none{{1, 2, 3}, Vector3d::Zero(), 2};
  CHECK(unit_force(none, {4, 6, 3}) == Vector3d::Zero());
  CHECK(distance(none, {4, 6, 3}) == 5);  // like a segment of no length, it is a point
}

TEST_CASE("inertia is an affine load", "[forces][inertia]") {
  RandomVectors vector;
  const InertiaForce inertia{Matrix3d::Random(), vector(), vector()};
  for (int trial = 0; trial < 20; ++trial) {
    const Vector3d p = vector();
    CHECK(distance(inertia, p) == 0);
    CHECK(
        (unit_force(inertia, p) - (inertia.offset + inertia.linear * (p - inertia.origin))).norm() <
        1e-14);
  }
}

TEST_CASE("a program's own force answers as the built-in ones do", "[forces]") {
  RandomVectors vector;
  const PointForce point{vector(), vector()};
  const SampledCustomForce mine{[&](const Vector3d& p) { return point.distance(p); },
                                [&](const Vector3d& p) { return point.unit_force(p); }};
  for (const Falloff kind : {Falloff::Linear, Falloff::Gaussian}) {
    const SampledForce built_in{point, 3, 1, 2, kind}, own{mine, 3, 1, 2, kind};
    const Vector3d p = vector();
    CHECK(distance(own.kind, p) == distance(built_in.kind, p));
    CHECK(force_at(own, p) == force_at(built_in, p));
  }
}

TEST_CASE("a falloff drawn as a line is the linear one", "[forces][falloff]") {
  CurveKeys<1> keys;
  keys.keys = {{.frame = 0, .value = {1}}, {.frame = 1, .value = {0}}};
  keys.keys.front().next.kind = Interpolation::Kind::Linear;
  const Curve<1> line = Curve<1>::make(keys).value();
  RandomVectors vector;
  for (int trial = 0; trial < 100; ++trial) {
    const PointForce point{vector(), vector()};
    const SampledForce drawn{point, 5, 1, 3, Falloff::Gaussian, &line};
    const SampledForce linear{point, 5, 1, 3, Falloff::Linear};
    const Vector3d p = vector();
    CHECK((force_at(drawn, p) - force_at(linear, p)).norm() < 1e-14);
  }
}

TEST_CASE("a drawn falloff is held beyond s = 1", "[forces][falloff]") {
  CurveKeys<1> keys;
  keys.keys = {{.frame = 0.2, .value = {3}}, {.frame = 0.9, .value = {-2}}};
  keys.after.kind = Extrapolation<1>::Kind::Linear;
  const Curve<1> curve = Curve<1>::make(keys).value();
  const SampledForce force{RadialForce{}, 1, 1, 2, Falloff::Constant, &curve};
  CHECK(force_at(force, {0.1, 0, 0}).x() == 3);
  CHECK(force_at(force, {2, 0, 0}).x() == force_at(force, {200, 0, 0}).x());
}

TEST_CASE("the region of a group selects and pushes nothing", "[forces][group]") {
  const SampledForce region = region_sphere({1, 2, 3}, 4);
  CHECK(distance(region.kind, {1, 5, 3}) == 3);
  CHECK(region.deformation_radius == 4);
  CHECK(region.force_radius == 0);
  CHECK(region.magnitude == 0);
}
