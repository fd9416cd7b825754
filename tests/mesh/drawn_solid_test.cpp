#include "pliant/mesh/drawn_solid.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "pliant/mesh/normals.hpp"
#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

struct Solid {
  SolidLengths lengths;
  DrawnSolid solid;
};

std::vector<Solid> solids() {
  const SolidLengths capsule{{0, 1.5, 0}, 0.4}, box{{0.7, 0.2, 1.1}, 0.3};
  return {{{.radius = 1.3}, make_ball_mesh(1.3)},
          {capsule, make_capsule_mesh(capsule)},
          {box, make_round_box_mesh(box)},
          {{.half = box.half}, make_sharp_box_mesh(box.half)}};
}

double volume_of(const Mesh& mesh) {
  double volume = 0;
  std::size_t corner = 0;
  for (const int size : mesh.face_sizes) {
    const auto at = [&](int k) -> Eigen::Vector3d {
      return mesh.positions.row(mesh.corner_vertices[corner + static_cast<std::size_t>(k)]);
    };
    for (int k = 2; k < size; ++k) volume += at(0).dot(at(k - 1).cross(at(k))) / 6;
    corner += static_cast<std::size_t>(size);
  }
  return volume;
}

}  // namespace

TEST_CASE("the mesh of a solid is closed and turned outwards", "[mesh][drawn_solid]") {
  for (const Solid& each : solids()) {
    const Mesh& mesh = each.solid.mesh;
    REQUIRE(check_mesh(mesh));
    std::map<std::pair<int, int>, int> ways;  // along each edge
    std::size_t first = 0;
    for (const int size : mesh.face_sizes) {
      for (int k = 0; k < size; ++k) {
        const auto corner = [&](int n) {
          return mesh.corner_vertices[first + static_cast<std::size_t>(n % size)];
        };
        ++ways[{corner(k), corner(k + 1)}];
      }
      first += static_cast<std::size_t>(size);
    }
    for (const auto& [edge, count] : ways) {
      CHECK(count == 1);
      CHECK(ways.contains({edge.second, edge.first}));
    }
    // Of the box, its sides and edges, and the ball: Steiner's formula. Chords take a little away.
    const auto& [half, r] = each.lengths;
    const Vector3d a = 2 * half;
    const double exact = a.prod() + 2 * r * (a[0] * a[1] + a[1] * a[2] + a[2] * a[0]) +
                         std::numbers::pi * r * r * a.sum() + 4 * std::numbers::pi / 3 * r * r * r;
    CHECK(volume_of(mesh) <= exact * (1 + 1e-12));
    CHECK(volume_of(mesh) >= exact * 0.99);
  }
}

TEST_CASE("the vertices of a solid lie on it, of whatever lengths", "[mesh][drawn_solid]") {
  for (const Solid& each : solids()) {
    const SolidLengths longer{1.7 * each.lengths.half, 0.6 * each.lengths.radius};
    for (const SolidLengths& lengths : {each.lengths, longer}) {
      const Field places = each.solid.positions(lengths);
      for (Eigen::Index k = 0; k < places.rows(); ++k) {
        const Vector3d place = places.row(k).transpose();
        const Vector3d out = (place.cwiseAbs() - lengths.half).cwiseMax(0);
        CHECK_THAT(out.norm(), WithinAbs(lengths.radius, 1e-14));
      }
      CHECK((places.colwise().maxCoeff().transpose() -
             (lengths.half + Vector3d::Constant(lengths.radius)))
                .cwiseAbs()
                .maxCoeff() < 1e-15);
    }
  }
}

TEST_CASE("a solid is shaded by its own normals", "[mesh][drawn_solid]") {
  for (const Solid& each : solids()) {
    const Mesh& mesh = each.solid.mesh;
    const Field normals = unit_normals(mesh, mesh.positions);
    for (std::size_t corner = 0; corner < mesh.corner_vertices.size(); ++corner) {
      const int vertex = mesh.corner_vertices[corner];
      const Vector3d direction = each.solid.directions.row(vertex).transpose();
      const Vector3d normal = normals.row(normal_of(mesh, corner)).transpose();
      if (each.lengths.radius > 0) {
        CHECK(normal.dot(direction) > 0.995);  // 6 degrees: less than half an edge step
      } else {
        CHECK(normal.cwiseAbs().maxCoeff() == 1);
        CHECK(normal.dot(Vector3d(each.solid.corners.row(vertex).transpose())) == 1);
      }
    }
  }
}
