#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "contact/scanned_way.hpp"
#include "contact/solid_meshes.hpp"
#include "pliant/contact/node_rows.hpp"
#include "pliant/contact/way.hpp"
#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

struct MeshChange {
  Kept from, to;
};

MeshSolid changed(const MeshSolid& solid, const Matrix3d& by) {
  return {std::make_shared<const PosedMesh>(solid.posed->shared_mesh(),
                                            solid.posed->points() * by.transpose())};
}

std::vector<MeshChange> mesh_changes() {
  Matrix3d turned;
  turned << 0.8, -0.6, 0, 0.6, 0.8, 0, 0.1, 0, 1.2;
  std::vector<MeshChange> all;
  for (const MeshSolid& solid : {box_mesh({1, 2, 0.6}, 2), ball_mesh(1, 4), hollow_mesh(),
                                 star_mesh(), box_with_needles({1, 2, 0.6}, 0)}) {
    all.push_back({{solid, 0}, {solid, 0}});
    all.push_back({{solid, 0.1}, {solid, 0.2}});
    all.push_back({{solid, 0}, {solid, 0.2}});
    all.push_back({{solid, 0}, {changed(solid, turned), 0}});
    all.push_back({{solid, 0.1}, {changed(solid, turned), 0.1}});
  }
  return all;
}

double gap_to_mesh(const MeshChange& change, const Vector3d& x0, const Vector3d& x1, double t) {
  const MeshWay way(*std::get<MeshSolid>(change.from.solid).posed,
                    *std::get<MeshSolid>(change.to.solid).posed);
  return way.nearness((1 - t) * x0 + t * x1, t).distance -
         ((1 - t) * change.from.offset + t * change.to.offset);
}

}  // namespace

TEST_CASE("the first contact with a mesh is the first moment at which the distance is 0",
          "[contact][mesh]") {
  for (const MeshChange& change : mesh_changes()) {
    const bool moves = !(change.from.solid == change.to.solid);
    int touched = 0;
    for (int k = 0; k < 60; ++k) {
      const Vector3d x0 = 2 * Vector3d::Random(), x1 = 2 * Vector3d::Random();
      CAPTURE(k, x0.transpose(), x1.transpose(), change.to.offset, moves);
      const ScannedWay way = scan([&](double t) { return gap_to_mesh(change, x0, x1, t); });
      const auto contact = first_contact(change.from, change.to, x0, x1, 1e-9);
      if (way.least < -1e-3) REQUIRE(contact);
      if (way.least > 1e-2) REQUIRE_FALSE(contact);
      if (!contact || way.first < 0) continue;
      ++touched;
      if (moves) continue;  // the mesh carries the place
      const double t = (contact->place - x0).norm() / (x1 - x0).norm();
      CHECK(t <= way.time() + 1e-9);
      if (way.first > 0) CHECK_THAT(gap_to_mesh(change, x0, x1, t), WithinAbs(0, 1e-12));
    }
    CHECK(touched > 5);
  }
}

TEST_CASE("a mesh of a box is met where the box is", "[contact][mesh]") {
  for (const double size : {1e-6, 1.0, 1e6}) {
    for (const double offset : {0.0, 0.1 * size}) {
      const Vector3d lengths = size * Vector3d(1, 2, 0.6);
      const Kept box{BoxSolid{lengths, 0}, offset}, mesh{box_mesh(lengths, 3), offset};
      int touched = 0;
      for (int k = 0; k < 500; ++k) {
        const Vector3d x0 = 2 * size * Vector3d::Random(), x1 = 2 * size * Vector3d::Random();
        CAPTURE(size, offset, k, x0.transpose(), x1.transpose());
        const auto expected = first_contact(box, box, x0, x1, 1e-9 * size);
        const auto found = first_contact(mesh, mesh, x0, x1, 1e-9 * size);
        REQUIRE(expected.has_value() == found.has_value());
        if (!found) continue;
        ++touched;
        CHECK((found->place - expected->place).norm() < 1e-10 * size);
        CHECK((found->normal - expected->normal).norm() < 1e-7);
        CHECK_THAT(found->support, WithinAbs(expected->support, 1e-8 * size));
      }
      CHECK(touched > 50);
    }
  }
}

TEST_CASE("no speed carries a node through a thin mesh", "[contact][mesh]") {
  for (const double thickness : {1e-3, 1e-6}) {
    const Kept plate{box_mesh({10, thickness, 10}, 4), 0};
    for (int k = 0; k < 200; ++k) {
      Vector3d x0 = 4 * Vector3d::Random(), x1 = 4 * Vector3d::Random();
      // Edges and corners of triangles too.
      if (k % 4 == 0) x0[0] = x1[0] = 2.5;
      if (k % 8 == 0) x0[2] = x1[2] = -2.5;
      if (k % 16 == 0) x0[0] = x0[2] = x1[0] = x1[2] = 1.25;
      x0[1] = 1000;
      x1[1] = -1000;
      const auto contact = first_contact(plate, plate, x0, x1, 1e-9);
      REQUIRE(contact);
      CHECK(contact->normal == Vector3d(0, 1, 0));
      CHECK_THAT(contact->place.y(), WithinAbs(thickness / 2, 1e-12));
    }
  }
}

TEST_CASE("what lies on a mesh and slides does not touch, and touches there if it is pressed in",
          "[contact][mesh]") {
  const Kept table{box_mesh({2, 1, 2}, 8), 0}, thick{box_mesh({2, 0.8, 2}, 8), 0.1};
  for (const Kept& kept : {table, thick}) {
    for (const double height : {0.5, 0.5 + 1e-15, 0.5 - 1e-13, 0.5 + 1e-12}) {
      const Vector3d x0(-0.71, height, 0.33);
      CHECK_FALSE(first_contact(kept, kept, x0, {0.83, height, -0.21}, 1e-9));
      CHECK_FALSE(first_contact(kept, kept, x0, {5, height, -3}, 1e-9));
      CHECK_FALSE(first_contact(kept, kept, x0, x0, 1e-9));
      const auto contact = first_contact(kept, kept, x0, {0.8, 0, -0.2}, 1e-9);
      REQUIRE(contact);
      CHECK_THAT(contact->place.y(), WithinAbs(0.5, 1e-11));
      CHECK_THAT(contact->place.x(), WithinAbs(x0[0], 1e-11));
    }
  }
}

TEST_CASE("a mesh carries what it touches by the place that was touched", "[contact][mesh]") {
  const MeshSolid low = box_mesh({2, 1, 2}, 2);
  Field points = low.posed->points();
  points.col(1).array() += 0.5;
  points.col(0).array() += 0.2;
  const MeshSolid high{std::make_shared<const PosedMesh>(low.posed->shared_mesh(), points)};
  // The top rises from 0.5 to 1 and meets a node at 0.75 half way.
  const auto contact = first_contact({low, 0}, {high, 0}, {0, 0.75, 0.1}, {0, 0.75, 0.1}, 1e-9);
  REQUIRE(contact);
  CHECK((contact->normal - Vector3d(0, 1, 0)).norm() < 1e-12);
  CHECK_THAT(contact->support, WithinAbs(1, 1e-9));
  CHECK((contact->place - Vector3d(0.1, 1, 0.1)).norm() < 1e-9);
}

TEST_CASE("rows do not depend on what is known of a mesh", "[contact][mesh]") {
  const Kept star{star_mesh(), 0.05};
  const PlacedCollider at{.kept = star};
  NearMesh known;
  Vector3d before = 2 * Vector3d::Random();
  for (int k = 0; k < 2000; ++k) {
    const Vector3d after = before + (k % 10 == 0 ? 1.0 : 0.1) * Vector3d::Random();
    const auto with = row_of(at, at, before, after, 1e-9, &known);
    const auto without = row_of(at, at, before, after, 1e-9);
    REQUIRE(with.has_value() == without.has_value());
    if (with) {
      CHECK(with->normal == without->normal);
      CHECK(with->height == without->height);
      CHECK(with->place == without->place);
    }
    before = after.norm() < 2.5 ? after : Vector3d(2 * Vector3d::Random());
  }
}
