#include "pliant/forces/batch.hpp"

#include <cmath>
#include <random>
#include <vector>

#include "support/catch.hpp"

using namespace pliant;

namespace {

double number(std::mt19937& random, double extent) {
  return std::uniform_real_distribution<double>(-extent, extent)(random);
}

// Sometimes with components that are 0 or equal, for which rounding and ties are frequent.
Vector3d place(std::mt19937& random, double extent) {
  Vector3d p{number(random, extent), number(random, extent), number(random, extent)};
  const auto kind = random() % 4;
  if (kind == 0) p[random() % 3] = 0;
  if (kind == 1) p = Vector3d(std::round(p[0]), std::round(p[1]), std::round(p[2]));
  return p;
}

std::vector<ForceKind> shapes(std::mt19937& random, double extent) {
  const Vector3d a = place(random, extent), b = place(random, extent), c = place(random, extent);
  return {PointForce{a, b},
          RadialForce{a},
          LineForce{a, b, {}},
          LineForce{a, b, c},
          LineForce{a, a, {}},
          UniformForce{a},
          VortexForce{a, b, 0.3},
          VortexForce{a, Vector3d::Zero(), 1},
          NoiseForce{a, 0.7, 1.5, 9},
          InertiaForce{Matrix3d::Random(), a, b},
          SampledCustomForce{[](const Vector3d& p) { return std::abs(p.x()); },
                             [](const Vector3d& p) { return Vector3d(2 * p); }}};
}

Batch batch_of(const std::vector<Vector3d>& points) {
  Batch batch;
  batch.count = static_cast<int>(points.size());
  for (int k = 0; k < batch.count; ++k) {
    batch.x[k] = points[k].x(), batch.y[k] = points[k].y(), batch.z[k] = points[k].z();
  }
  return batch;
}

}  // namespace

TEST_CASE("a batch of positions gets the bits that each gets alone", "[forces][batch]") {
  std::mt19937 random(5);
  const Curve<1> drawn =
      Curve<1>::make({.keys = {{.frame = 0, .value = {1}}, {.frame = 1, .value = {0.25}}}}).value();
  for (int trial = 0; trial < 200; ++trial) {
    const double extent = trial % 2 ? 10 : 1e-3;
    std::vector<Vector3d> points;
    for (int count = 1 + static_cast<int>(random() % batch_size); count > 0; --count) {
      points.push_back(place(random, extent));
    }
    const Batch batch = batch_of(points);
    for (const ForceKind& shape : shapes(random, extent)) {
      const BatchNumbers found = distances(shape, batch);
      for (int k = 0; k < batch.count; ++k) REQUIRE(found.of[k] == distance(shape, points[k]));
      SampledForce force;
      force.kind = shape;
      force.magnitude = number(random, 5);
      force.force_radius = 1.3 * extent;
      force.falloff = static_cast<Falloff>(random() % 4);
      force.falloff_curve = trial % 5 == 0 ? &drawn : nullptr;
      const int first = batch_size - batch.count;
      Batch sums = batch_of(std::vector<Vector3d>(batch_size, Vector3d(1, -2, 0)));
      add_forces(force, batch, nullptr, 0, first, sums);
      for (int k = 0; k < first; ++k) REQUIRE(sums.at(k) == Vector3d(1, -2, 0));
      for (int k = 0; k < batch.count; ++k) {
        REQUIRE(sums.at(first + k) == Vector3d(1, -2, 0) + force_at(force, points[k]));
      }
    }
  }
}

TEST_CASE("a force adds what it has for a node, faded like the rest of it", "[forces][batch]") {
  std::mt19937 random(8);
  Field of_nodes(50, 3);
  std::vector<Vector3d> points;
  for (int node = 0; node < 50; ++node) of_nodes.row(node) = place(random, 3).transpose();
  for (int k = 0; k < 20; ++k) points.push_back(place(random, 10));
  const Curve<1> half = Curve<1>::make({.keys = {{.frame = 0, .value = {0.5}}}}).value();
  SampledForce force, plain;
  force.magnitude = plain.magnitude = -3;
  force.falloff_curve = plain.falloff_curve = &half;
  plain.kind = InertiaForce{.offset = {1, 2, 3}};
  force.kind =
      InertiaForce{.offset = {1, 2, 3}, .of_nodes = std::make_shared<const Field>(of_nodes)};
  Batch sums = batch_of(std::vector<Vector3d>(batch_size, Vector3d(1, -2, 0)));
  add_forces(force, batch_of(points), nullptr, 30, 5, sums);
  for (int k = 0; k < 20; ++k) {
    const Vector3d own = -1.5 * of_nodes.row(30 + k).transpose();
    const Vector3d load = force_on(force, points[k], 30 + k, Vector3d::Zero());
    CHECK(load == force_at(plain, points[k]) + own);
    CHECK(sums.at(5 + k) == Vector3d(1, -2, 0) + load);
    CHECK(force_on(plain, points[k], 30 + k, Vector3d::Zero()) == force_at(plain, points[k]));
  }
}

TEST_CASE("no position of a box is nearer than the bound says", "[forces][batch]") {
  std::mt19937 random(6);
  int tight = 0, far = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const double extent = std::pow(10.0, number(random, 6));
    // A box that is small relative to its coordinates, so that rounding matters; or flat, or a
    // single point.
    const double size = trial % 3 == 0 ? 1e-12 * extent : 0.1 * extent;
    const Vector3d corner = place(random, extent);
    Vector3d low = corner, high = corner;
    std::vector<Vector3d> points = {corner};
    for (int k = 0; k < 12 && trial % 7 != 0; ++k) {
      Vector3d p = corner + place(random, size);
      if (trial % 5 == 0) p.y() = corner.y();
      low = low.cwiseMin(p), high = high.cwiseMax(p);
      points.push_back(p);
    }
    points.push_back(low), points.push_back(high);
    for (const ForceKind& shape : shapes(random, extent)) {
      const double bound = least_distance(shape, low, high);
      REQUIRE(bound >= 0);
      far += bound > 0;
      for (const Vector3d& p : points) {
        const double delta = distance(shape, p);
        REQUIRE(bound <= delta);
        tight += bound == delta && bound > 0;
      }
    }
  }
  // The bound is useful, and sometimes exact.
  CHECK(far > 5000);
  CHECK(tight > 500);
}
