#include "pliant/contact/solid_mesh.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "contact/solid_meshes.hpp"
#include "pliant/contact/way.hpp"
#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

MeshNearness near_mesh(const MeshSolid& solid, const Vector3d& x) {
  return MeshWay(*solid.posed, *solid.posed).nearness(x, 0);
}

// The slow way: every triangle, and the angle that the whole is seen under.
double slow_distance(const MeshSolid& solid, const Vector3d& x) {
  const Field& points = solid.posed->points();
  double least = std::numeric_limits<double>::infinity(), angle = 0;
  for (const auto& corners : solid.posed->mesh().triangles()) {
    std::array<Vector3d, 3> at;
    for (int k = 0; k < 3; ++k) at[k] = points.row(corners[k]).transpose() - x;
    const double a = at[0].norm(), b = at[1].norm(), c = at[2].norm();
    angle += 2 * std::atan2(at[0].dot(at[1].cross(at[2])), a * b * c + at[0].dot(at[1]) * c +
                                                               at[0].dot(at[2]) * b +
                                                               at[1].dot(at[2]) * a);
    // Samples of it, then the best of its sides.
    const Vector3d normal = (at[1] - at[0]).cross(at[2] - at[0]);
    const double size = normal.squaredNorm();
    if (size > 0) {
      const Vector3d foot = at[0].dot(normal) / size * normal;
      bool is_within = true;
      for (int k = 0; k < 3; ++k) {
        const Vector3d side = at[(k + 1) % 3] - at[k];
        is_within = is_within && side.cross(foot - at[k]).dot(normal) >= 0;
      }
      if (is_within) least = std::min(least, foot.norm());
    }
    for (int k = 0; k < 3; ++k) {
      const Vector3d side = at[(k + 1) % 3] - at[k];
      const double t =
          side.squaredNorm() > 0 ? std::clamp(-at[k].dot(side) / side.squaredNorm(), 0.0, 1.0) : 0;
      least = std::min(least, (at[k] + t * side).norm());
    }
  }
  return angle > 6 ? -least : least;
}

}  // namespace

TEST_CASE("the distance to a mesh is that to all its triangles, < 0 where it encloses",
          "[contact][mesh]") {
  for (const MeshSolid& solid : {box_mesh({1, 2, 0.6}, 1), box_mesh({1, 2, 0.6}, 5),
                                 ball_mesh(1, 12), hollow_mesh(), star_mesh()}) {
    int inside = 0;
    for (int k = 0; k < 400; ++k) {
      const Vector3d x = 1.5 * Vector3d::Random();
      CAPTURE(k, x.transpose());
      const MeshNearness near = near_mesh(solid, x);
      const double expected = slow_distance(solid, x);
      CHECK_THAT(near.distance, WithinAbs(expected, 1e-13));
      CHECK_THAT(near.normal.norm(), WithinAbs(1, 1e-12));
      const Vector3d foot = MeshWay(*solid.posed, *solid.posed).place(near.foot, 0);
      CHECK((x - near.distance * near.normal - foot).norm() < 1e-12);
      inside += near.distance < 0 ? 1 : 0;
    }
    CHECK(inside > 5);
  }
}

TEST_CASE("a search that begins with any triangle finds the same", "[contact][mesh]") {
  const MeshSolid solid = star_mesh();
  const MeshWay way(*solid.posed, *solid.posed);
  const auto count = static_cast<int>(solid.posed->mesh().triangles().size());
  // On the planes of symmetry several triangles are equally close.
  for (const Vector3d& x :
       std::vector<Vector3d>{{0, 0, 0}, {0.2, 0.2, 0}, {0, 0.9, 0}, {2, 2, 2}}) {
    const MeshNearness expected = way.nearness(x, 0);
    for (int near = 0; near < count; ++near) {
      const MeshNearness found = way.nearness(x, 0, near);
      CHECK(found.foot.triangle == expected.foot.triangle);
      CHECK(found.distance == expected.distance);
      CHECK(found.normal == expected.normal);
    }
  }
}

TEST_CASE("a mesh of a box is as near as the box", "[contact][mesh]") {
  for (const double size : {1e-6, 1.0, 1e6}) {
    const Vector3d lengths = size * Vector3d(1, 2, 0.6);
    const Solid box = BoxSolid{lengths, 0}, mesh = box_mesh(lengths, 3);
    for (int k = 0; k < 500; ++k) {
      const Vector3d x = size * 1.3 * Vector3d::Random();
      const Nearness expected = nearness(box, x), found = nearness(mesh, x);
      CAPTURE(k, x.transpose());
      CHECK_THAT(found.distance, WithinAbs(expected.distance, 1e-14 * size));
      CHECK((found.normal - expected.normal).norm() < 1e-9);
    }
  }
}

TEST_CASE("needles, triangles without area and corners between sides change no distance",
          "[contact][mesh]") {
  const MeshSolid good = box_mesh({1, 2, 0.6}, 1);
  for (const double height : {0.0, 1e-15, 1e-12, 1e-9}) {
    const MeshSolid poor = box_with_needles({1, 2, 0.6}, height);
    REQUIRE(poor.posed->mesh().triangles().size() > good.posed->mesh().triangles().size());
    for (int k = 0; k < 500; ++k) {
      const Vector3d x = 1.3 * Vector3d::Random();
      CAPTURE(height, k, x.transpose());
      const MeshNearness found = near_mesh(poor, x), expected = near_mesh(good, x);
      CHECK_THAT(found.distance, WithinAbs(expected.distance, 1e-14 + 2 * height));
      CHECK(found.normal.allFinite());
    }
    // On the edges themselves, and at the corners.
    for (Eigen::Index k = 0; k < poor.posed->points().rows(); ++k) {
      const Vector3d x = poor.posed->points().row(k).transpose();
      const MeshNearness found = near_mesh(poor, x);
      CHECK_THAT(found.distance, WithinAbs(0, 1e-14 + 2 * height));
      CHECK_THAT(found.normal.norm(), WithinAbs(1, 1e-12));
      // It points away from the middle of the box.
      CHECK(found.normal.dot(x) > 0);
    }
  }
}

TEST_CASE("what is flat everywhere has finite distances", "[contact][mesh]") {
  MeshSolid flat = box_mesh({1, 2, 0.6}, 2);
  for (const Vector3d& scale :
       std::vector<Vector3d>{{1, 0, 1}, {0, 0, 1}, {0, 0, 0}, {1, 1e-300, 1}, {1e-120, 1e-90, 1}}) {
    const MeshSolid solid{PosedMesh::scaled(flat.posed, scale)};
    for (const Vector3d& x :
         std::vector<Vector3d>{{0, 0, 0}, {0, 0.3, 0}, {3, 1, 2}, {0.5, 0, 0}}) {
      const MeshNearness found = near_mesh(solid, x);
      CHECK(std::isfinite(found.distance));
      CHECK_THAT(found.normal.norm(), WithinAbs(1, 1e-12));
    }
  }
}

TEST_CASE("lengths whose squares overflow end in no number that is not one", "[contact][mesh]") {
  const MeshSolid box = box_mesh({1, 2, 0.6}, 2);
  for (const double size : {1e80, 1e160, 1e300}) {
    const MeshSolid solid{PosedMesh::scaled(box.posed, {size, size, size})};
    const Kept kept{solid, 0};
    for (const Vector3d& x : std::vector<Vector3d>{{0, 0, 0}, {3, 1, 2}}) {
      const MeshNearness found = near_mesh(solid, size * x);
      CHECK_FALSE(std::isnan(found.distance));
      CHECK_FALSE(found.normal.hasNaN());
      static_cast<void>(first_contact(kept, kept, size * x, -size * x, 1e-9));
    }
  }
}

TEST_CASE("a mesh is turned outwards, also by a mirror", "[contact][mesh]") {
  const MeshSolid box = box_mesh({1, 2, 0.6}, 2);
  auto triangles = box.posed->mesh().triangles();
  for (auto& corners : triangles) std::swap(corners[0], corners[1]);
  const auto turned = solid_of(triangles, box.posed->points());
  const MeshSolid mirrored{PosedMesh::scaled(box.posed, {-1, 1, 1})};
  for (const MeshSolid& solid : {turned, mirrored}) {
    CHECK(near_mesh(solid, {0, 0, 0}).distance == -0.3);
    CHECK(near_mesh(solid, {0, 0, 1.3}).distance == 1);
    CHECK(near_mesh(solid, {0, 0, 1.3}).normal == Vector3d(0, 0, 1));
  }
}

TEST_CASE("edges of triangles that are not closed are found", "[contact][mesh]") {
  auto triangles = box_mesh({1, 1, 1}, 1).posed->mesh().triangles();
  CHECK_FALSE(SolidMesh::open_edge(triangles));
  auto turned = triangles;
  std::swap(turned[3][0], turned[3][1]);
  CHECK(SolidMesh::open_edge(turned)->sides == 2);
  auto doubled = triangles;
  doubled.push_back({triangles[0][0], triangles[0][1], 7});
  CHECK(SolidMesh::open_edge(doubled)->sides == 3);
  const auto last = triangles.back();
  triangles.pop_back();
  const OpenEdge open = SolidMesh::open_edge(triangles).value();
  CHECK(open.sides == 1);
  const auto has = [&](int point) { return std::ranges::find(last, point) != last.end(); };
  CHECK((has(open.from) && has(open.to)));
}
