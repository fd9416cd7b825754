#include "pliant/contact/node_rows.hpp"

#include <cmath>
#include <vector>

#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

PlacedCollider ball_at(const Vector3d& center, double radius = 1) {
  return {Matrix3d::Identity(), center, {SphereSolid{radius}, 0}};
}

NodeRow row_along(const Vector3d& n, double height, int node = 7) {
  NodeRow row;
  row.node = node;
  row.normal = n.normalized();
  row.height = height;
  return row;
}

}  // namespace

TEST_CASE("behind the row of a convex solid lies all of it", "[contact][rows]") {
  const SampledCollider collider{
      {BoxSolid{{1, 2, 1}, 0.1}, {{0, 3, 0}, {0, 0, 10}, {1, 1, 1}}, 0.05},
      {BoxSolid{{2, 1, 1}, 0.3}, {{0, -1, 0}, {40, 0, 5}, {1, 1, 2}}, 0.1}};
  const PlacedCollider from = placed(collider, 0.25), to = placed(collider, 0.5);
  int touched = 0;
  for (int k = 0; k < 500; ++k) {
    const Vector3d before = 2 * Vector3d::Random() + Vector3d(0, 2, 0);
    const Vector3d after = 2 * Vector3d::Random() + Vector3d(0, 1, 0);
    const auto row = row_of(from, to, before, after, 1e-9);
    if (!row) continue;
    ++touched;
    // Whatever satisfies the row is not inside.
    for (int m = 0; m < 50; ++m) {
      Vector3d p = after + 2 * Vector3d::Random();
      p += std::max(0.0, row->lack(p)) * row->normal;
      CHECK(nearness(to.kept, to.to_frame(p)).distance > -1e-12);
    }
  }
  CHECK(touched > 50);
}

TEST_CASE("a row turns with the solid and holds what came to lie on it", "[contact][rows]") {
  // A floor that turns by a quarter about z.
  const SampledCollider floor{{PlaneSolid{}, {}, 0}, {PlaneSolid{}, {{5, 0, 0}, {0, 0, 90}}, 0}};
  const auto row = row_of(placed(floor, 0), placed(floor, 1), {2, 0, 1}, {6, 3, 1}, 1e-9);
  REQUIRE(row);
  CHECK((row->normal - Vector3d(-1, 0, 0)).norm() < 1e-15);
  CHECK_THAT(row->lack({5, 9, 9}), WithinAbs(0, 1e-14));
  CHECK_THAT(row->lack(row->place), WithinAbs(0, 1e-12));
}

TEST_CASE("what stays away has no row", "[contact][rows]") {
  const PlacedCollider ball = ball_at({0, 0, 0});
  CHECK_FALSE(row_of(ball, ball, {3, 0, 0}, {0, 3, 0}, 1e-9));
  CHECK_FALSE(row_of(ball, ball, {3, 0, 0}, {1.5, 0, 0}, 1e-9));
  CHECK(row_of(ball, ball, {3, 0, 0}, {-3, 0, 0}, 1e-9));
}

TEST_CASE("of two rows of one wall the one that lacks more stays", "[contact][rows]") {
  NodeRows rows;
  const Vector3d at(0, 0, 0);
  CHECK(rows.add(row_along({0, 1, 0}, 1), at) == NodeRows::Offer::Taken);
  CHECK(rows.add(row_along({0.01, 1, 0}, 0.5), at) == NodeRows::Offer::Same);
  CHECK(rows.all().front().height == 1);
  CHECK(rows.add(row_along({0, 1, 0}, 1), at) == NodeRows::Offer::Same);
  CHECK(rows.add(row_along({0.01, 1, 0}, 2), at) == NodeRows::Offer::Same);
  CHECK(rows.all().size() == 1);
  CHECK(rows.all().front().height == 2);
}

TEST_CASE("against an earlier row none is taken, and never a fourth", "[contact][rows]") {
  NodeRows rows;
  const Vector3d at(0, 0, 0);
  CHECK(rows.add(row_along({0, 1, 0}, 1), at) == NodeRows::Offer::Taken);
  CHECK(rows.add(row_along({0.1, -1, 0}, 5), at) == NodeRows::Offer::Squeezed);
  CHECK(rows.add(row_along({1, 0.1, 0}, 1), at) == NodeRows::Offer::Taken);
  CHECK(rows.add(row_along({1, 1, 0.05}, 9), at) == NodeRows::Offer::Dropped);
  CHECK(rows.add(row_along({0, 0.2, 1}, 1), at) == NodeRows::Offer::Taken);
  CHECK(rows.add(row_along({-0.7, 0, 0.7}, 1), at) == NodeRows::Offer::Dropped);
  CHECK(rows.add(row_along({0, 1, 0}, 1, 3), at) == NodeRows::Offer::Taken);
  const std::vector<NodeRow> all = rows.all();
  CHECK(all.size() == 4);
  CHECK(all.front().node == 3);
  CHECK(all.back().normal.z() > 0.9);
}

TEST_CASE("a collider on its way has the numbers of its pose between", "[contact][rows]") {
  const SampledCollider collider{{SphereSolid{1}, {{0, 0, 0}, {0, 0, 0}, {2, 2, -2}}, 0.5},
                                 {SphereSolid{3}, {{4, 8, 0}, {0, 180, 0}, {4, 4, 4}}, 0.1}};
  const PlacedCollider half = placed(collider, 0.5);
  CHECK(half.translation == Vector3d(2, 4, 0));
  // 2 times a scale of 3.
  CHECK(std::get<SphereSolid>(half.kept.solid).radius == 6);
  CHECK_THAT(half.kept.offset, WithinAbs(0.3, 1e-16));
  // A quarter turn about y.
  CHECK((half.turned({1, 0, 0}) - Vector3d(0, 0, -1)).norm() < 1e-15);
  CHECK((half.to_world(half.to_frame({1, 2, 3})) - Vector3d(1, 2, 3)).norm() < 1e-14);
}
