#include "pliant/contact/solid.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

const std::vector<Solid> solids = {SphereSolid{1.3},
                                   CapsuleSolid{0.4, 2.2},
                                   CapsuleSolid{0.7, 0},
                                   BoxSolid{{1, 2, 0.6}, 0},
                                   BoxSolid{{1, 2, 0.6}, 0.2},
                                   BoxSolid{{1, 2, 0.6}, 0.3},
                                   PlaneSolid{}};

std::vector<Vector3d> places() {
  std::vector<Vector3d> all;
  for (int k = 0; k < 400; ++k) all.emplace_back(2 * Vector3d::Random());
  return all;
}

}  // namespace

TEST_CASE("a normal is the gradient of the distance, of length 1", "[contact][solid]") {
  for (const Solid& solid : solids) {
    for (const Vector3d& x : places()) {
      const Nearness near = nearness(solid, x);
      CAPTURE(solid.index(), x.transpose());
      CHECK_THAT(near.normal.norm(), WithinAbs(1, 1e-14));
      const double step = 1e-7;
      Vector3d gradient;
      for (int k = 0; k < 3; ++k) {
        gradient[k] = (nearness(solid, x + step * Vector3d::Unit(k)).distance -
                       nearness(solid, x - step * Vector3d::Unit(k)).distance) /
                      (2 * step);
      }
      // Where faces of a box are equally near there is none.
      if (std::abs(gradient.norm() - 1) > 1e-6) continue;
      CHECK((gradient - near.normal).norm() < 1e-5);
    }
  }
}

TEST_CASE("a solid lies behind the plane at its surface, which touches it", "[contact][solid]") {
  for (const Solid& solid : solids) {
    for (const Vector3d& x : places()) {
      const Nearness near = nearness(solid, x);
      CAPTURE(solid.index(), x.transpose());
      // The place of the surface that is nearest.
      const Vector3d foot = x - near.distance * near.normal;
      CHECK_THAT(nearness(solid, foot).distance, WithinAbs(0, 1e-12));
      CHECK_THAT(near.normal.dot(foot), WithinAbs(support(solid, near.normal), 1e-12));
    }
  }
}

TEST_CASE("distances to boxes and capsules are those of lengths along their axes",
          "[contact][solid]") {
  const Solid box = BoxSolid{{2, 4, 6}, 0.5};
  CHECK(nearness(box, {3, 0, 0}).distance == 2);
  CHECK(nearness(box, {0, -3, 0}).distance == 1);
  CHECK(nearness(box, {0, 0, 2}).distance == -1);
  CHECK(nearness(box, {0.9, 0, 0}).normal == Vector3d(1, 0, 0));
  CHECK_THAT(nearness(box, {1, 2, 3}).distance, WithinAbs((std::sqrt(3.0) - 1) * 0.5, 1e-15));
  const Solid capsule = CapsuleSolid{0.5, 2};
  CHECK(nearness(capsule, {0, 2, 0}).distance == 0.5);
  CHECK(nearness(capsule, {0, 0.7, -2}).distance == 1.5);
}

TEST_CASE("where several normals are equal, one is chosen", "[contact][solid]") {
  CHECK(nearness(SphereSolid{1}, {0, 0, 0}).normal == Vector3d(0, 1, 0));
  CHECK(nearness(CapsuleSolid{1, 2}, {0, 0.3, 0}).normal == Vector3d(1, 0, 0));
  CHECK(nearness(BoxSolid{{1, 1, 1}, 0}, {0, 0, 0}).normal == Vector3d(1, 0, 0));
  CHECK(nearness(BoxSolid{{1, 1, 1}, 0}, {0.2, -0.2, 0.2}).normal == Vector3d(1, 0, 0));
  CHECK(nearness(BoxSolid{{2, 1, 1}, 0}, {0, -0.2, 0.2}).normal == Vector3d(0, -1, 0));
}

TEST_CASE("lengths between two solids give what is between their supports", "[contact][solid]") {
  const auto check = [](const Solid& one, const Solid& other) {
    for (const Vector3d& x : places()) {
      const Vector3d n = x.normalized();
      const double t = 0.3;
      CHECK_THAT(support(between(one, other, t), n),
                 WithinAbs(0.7 * support(one, n) + 0.3 * support(other, n), 1e-14));
    }
    CHECK(between(one, one, 0.3) == one);
  };
  check(SphereSolid{1}, SphereSolid{3});
  check(CapsuleSolid{1, 0.3}, CapsuleSolid{0.2, 2});
  check(BoxSolid{{1, 2, 3}, 0.1}, BoxSolid{{4, 1, 3}, 0.5});
}

TEST_CASE("no place of a solid is beyond its reach", "[contact][solid]") {
  for (const Solid& solid : solids) {
    for (const Vector3d& x : places())
      CHECK(nearness(solid, x).distance >= x.norm() - reach(solid) - 1e-12);
  }
}
