#include "pliant/contact/way.hpp"

#include <cmath>
#include <vector>

#include "contact/scanned_way.hpp"
#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

struct Change {
  Kept from, to;
};

const std::vector<Change> changes = {
    {{SphereSolid{1}, 0}, {SphereSolid{1}, 0}},
    {{SphereSolid{0.4}, 0}, {SphereSolid{1.2}, 0.1}},
    {{CapsuleSolid{0.4, 1}, 0}, {CapsuleSolid{0.3, 2}, 0}},
    {{BoxSolid{{1, 2, 0.6}, 0}, 0}, {BoxSolid{{1, 2, 0.6}, 0}, 0}},
    {{BoxSolid{{1, 2, 0.6}, 0.2}, 0}, {BoxSolid{{2, 1, 0.7}, 0.1}, 0.2}},
    {{PlaneSolid{}, 0.1}, {PlaneSolid{}, 0.3}},
};

double distance(const Change& change, const Vector3d& x0, const Vector3d& x1, double t) {
  const Kept kept{between(change.from.solid, change.to.solid, t),
                  (1 - t) * change.from.offset + t * change.to.offset};
  return nearness(kept, (1 - t) * x0 + t * x1).distance;
}

}  // namespace

TEST_CASE("the first contact is the first moment at which the distance is 0", "[contact][way]") {
  for (const Change& change : changes) {
    int touched = 0;
    for (int k = 0; k < 300; ++k) {
      const Vector3d x0 = 2 * Vector3d::Random(), x1 = 2 * Vector3d::Random();
      CAPTURE(k, x0.transpose(), x1.transpose());
      const ScannedWay way = scan([&](double t) { return distance(change, x0, x1, t); });
      const auto contact = first_contact(change.from, change.to, x0, x1, 1e-9);
      if (way.least < -1e-3) REQUIRE(contact);
      if (way.least > 1e-3) REQUIRE_FALSE(contact);
      if (!contact || way.first < 0) continue;
      ++touched;
      const double t = (contact->place - x0).norm() / (x1 - x0).norm();
      CHECK_THAT(t, WithinAbs(way.time(), 1.0 / ScannedWay::moments));
      if (way.first > 0) CHECK_THAT(distance(change, x0, x1, t), WithinAbs(0, 1e-12));
    }
    CHECK(touched > 20);
  }
}

TEST_CASE("a node that begins inside touches at once", "[contact][way]") {
  const Kept ball{SphereSolid{1}, 0};
  const auto contact = first_contact(ball, ball, {0.5, 0, 0}, {3, 0, 0}, 1e-9);
  REQUIRE(contact);
  CHECK(contact->place == Vector3d(0.5, 0, 0));
  CHECK(contact->normal == Vector3d(1, 0, 0));
}

TEST_CASE("what grazes a solid by less than the slack does not touch", "[contact][way]") {
  const Kept ball{SphereSolid{1}, 0};
  for (const double depth : {1e-3, 1e-8, 2e-9}) {
    CHECK(first_contact(ball, ball, {-5, 1 - depth, 0}, {5, 1 - depth, 0}, 1e-9));
  }
  for (const double depth : {5e-10, 0.0, -1e-9})
    CHECK_FALSE(first_contact(ball, ball, {-5, 1 - depth, 0}, {5, 1 - depth, 0}, 1e-9));
}

TEST_CASE("a fast node does not pass through a thin plate", "[contact][way]") {
  const Kept plate{BoxSolid{{10, 1e-3, 10}, 0}, 0};
  const auto contact = first_contact(plate, plate, {0.1, 500, 0.2}, {-0.1, -500, 0.2}, 1e-9);
  REQUIRE(contact);
  CHECK(contact->normal == Vector3d(0, 1, 0));
  CHECK_THAT(contact->place.y(), WithinAbs(5e-4, 1e-12));
}

TEST_CASE("a node that rests on a solid and is pressed in touches where it lies",
          "[contact][way]") {
  const Kept floor{PlaneSolid{}, 0.25};
  for (const double height : {0.25, 0.25 + 1e-17, 0.25 + 1e-12, 0.25 - 1e-12}) {
    const auto contact = first_contact(floor, floor, {1, height, 2}, {1, 0, 2}, 1e-9);
    REQUIRE(contact);
    CHECK_THAT(contact->place.y(), WithinAbs(0.25, 1e-11));
  }
}
