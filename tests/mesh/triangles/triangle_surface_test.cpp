#include "pliant/mesh/triangles/triangle_surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pliant/mesh/grid_sheet.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

TriangleSurface surface_of(const std::vector<Vector3d>& positions,
                           const std::vector<std::vector<int>>& faces,
                           const MeshReading& reading = {}) {
  return make_surface(mesh_of(positions, faces), reading).value();
}

double length(const std::array<double, 2>& a) { return std::sqrt(a[0] * a[0] + a[1] * a[1]); }

const std::vector<Vector3d> five_places = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}};

}  // namespace

TEST_CASE("vertices in one place are one node, that of the lowest", "[mesh][surface]") {
  std::vector<Vector3d> positions = five_places;
  positions.push_back(five_places[1]);                         // 5: a seam
  positions.push_back(five_places[2] + Vector3d(0, 0, 1e-6));  // 6: nearly a seam
  positions.push_back({9, 9, 9});                              // 7: in no face
  const std::vector<std::vector<int>> faces = {{0, 1, 2, 3}, {5, 4, 6}};
  const TriangleSurface s = surface_of(positions, faces);
  CHECK(s.vertex_nodes == std::vector{0, 1, 2, 3, 4, 1, 2, -1});
  CHECK(s.rest.row(2) == five_places[2].transpose());
  CHECK(s.node_count() == 5);
  const TriangleSurface exact = surface_of(positions, faces, {.weld = 0});
  CHECK(exact.vertex_nodes == std::vector{0, 1, 2, 3, 4, 1, 5, -1});
}

TEST_CASE("faces that make no sense take no part", "[mesh][surface]") {
  const TriangleSurface s = surface_of(
      five_places,
      {{0, 1, 2}, {2, 0, 1}, {0, 2, 1}, {0, 1, 1}, {0, 1, 0, 2}, {1, 1, 4, 2, 2}, {3, 3, 3}});
  CHECK(s.face_count() == 2);
  CHECK(s.faces_left_out == 5);
  CHECK(std::vector(s.nodes_of(1).begin(), s.nodes_of(1).end()) == std::vector{1, 4, 2});
  CHECK(std::vector(s.faces_of(1).begin(), s.faces_of(1).end()) == std::vector{0, 1});
  CHECK(s.mesh_corners == std::vector{0, 1, 2, 16, 18, 19});
  const auto none = make_surface(mesh_of(five_places, {{0, 1, 1}, {2, 2, 2}}));
  REQUIRE_FALSE(none);
  CHECK_THAT(none.error().message, contains_text("none of the mesh's 2 faces"));
}

TEST_CASE("edges count the sides that lie on them", "[mesh][surface]") {
  const TriangleSurface s = surface_of(five_places, {{0, 1, 2}, {0, 2, 3}, {1, 4, 2}, {2, 1, 3}});
  const auto sides = [&](int face, int side) { return s.edge_sides[s.edges_of(face)[side]]; };
  CHECK(s.edge_count() == 8);
  CHECK(sides(0, 0) == 1);  // 0-1
  CHECK(sides(0, 1) == 3);  // 1-2, a branch
  CHECK(sides(0, 2) == 2);  // 2-0
  CHECK(s.edges_of(0)[1] == s.edges_of(2)[2]);
  CHECK(s.edges_of(0)[1] == s.edges_of(3)[0]);
}

TEST_CASE("an edge may belong to 256 faces, but not to more", "[mesh][surface]") {
  const auto book = [](int pages) {
    std::vector<Vector3d> places = {{0, 0, 0}, {0, 0, 1}};
    std::vector<std::vector<int>> faces;
    for (int k = 0; k < pages; ++k) {
      const double turn = 2 * std::numbers::pi * k / pages;
      places.emplace_back(std::cos(turn), std::sin(turn), 0.5);
      faces.push_back({0, 1, k + 2});
    }
    return make_surface(mesh_of(places, faces));
  };
  CHECK(book(256).value().edge_sides.front() == 256);
  CHECK_THAT(book(257).error().message, contains_text("between the vertices 0 and 1 belongs to"));
}

TEST_CASE("a face of more than three corners is a fan round its centre", "[mesh][surface]") {
  const TriangleSurface s = surface_of(five_places, {{0, 1, 2, 3}, {1, 4, 2}});
  CHECK(s.triangle_starts == std::vector{0, 4, 5});
  double area = 0;
  for (const FlatTriangle& triangle : s.triangles) area += triangle.signed_area();
  CHECK(area == 1.5);
  CHECK(s.unit[0] == std::sqrt(1.5));
  CHECK(s.unit[1] == s.unit[0]);
  CHECK(s.triangles[0].b == std::array{1.0, 0.0});
  CHECK(s.triangles[0].c == std::array{0.5, 0.5});
}

TEST_CASE("u follows the axis, another one, or the first edge", "[mesh][surface]") {
  const double root = std::sqrt(0.5);
  // In the xy-plane.
  const auto along = [&](const std::array<double, 3>& axis) {
    return surface_of({{0, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}}, {.axis = axis}).triangles[0];
  };
  CHECK(along({5, 0, 0}).b == std::array{1.0, 1.0});
  CHECK(along({0, 1e200, 0}).b == std::array{1.0, -1.0});
  CHECK(along({0.2, 0, -1}).b == std::array{1.0, 1.0});  // slanted, but long enough
  CHECK(along({0.05, 0, 1}).c[0] == 0.05 * 0 + along({1, 0.05, 0}).c[0]);  // (z, x, y)
  // Both lie across a triangle whose normal is (1, 1, 1): then the first edge.
  const TriangleSurface slanted = surface_of({{0, 0, 0}, {1, -1, 0}, {0, 1, -1}}, {{0, 1, 2}},
                                             {.axis = std::array{1.0, 1.0, 1.0}});
  CHECK(length(slanted.triangles[0].b) == slanted.triangles[0].b[0]);
  CHECK(slanted.triangles[0].b[0] == Approx(2 * root));
}

TEST_CASE("without an axis, u and v follow the UVs, also mirrored ones", "[mesh][surface]") {
  Mesh mesh = mesh_of({{0, 0, 0}, {2, 0, 0}, {0, 3, 0}}, {{0, 1, 2}});
  mesh.corner_uvs = {0, 1, 2};
  mesh.uvs = {{0, 0}, {0, 1}, {1, 0}};  // u along y, v along x
  const FlatTriangle mirrored = make_surface(mesh).value().triangles[0];
  CHECK(mirrored.b == std::array{0.0, 2.0});
  CHECK(mirrored.c == std::array{3.0, 0.0});
  CHECK(mirrored.signed_area() == -3);
  mesh.uvs[1] = {1e-13, 1};
  mesh.uvs[2] = {0, 1};  // nearly folded to a line: the axis 1 0 0
  CHECK(make_surface(mesh).value().triangles[0].b == std::array{2.0, 0.0});
  mesh.corner_uvs[2] = -1;
  CHECK(make_surface(mesh).value().triangles[0].b == std::array{2.0, 0.0});
}

TEST_CASE("a triangle laid flat has the sizes of the one in space", "[mesh][surface]") {
  const Mesh ball = sphere(2);
  const TriangleSurface s = make_surface(ball).value();
  for (int face = 0; face < s.face_count(); ++face) {
    const std::span<const int> nodes = s.nodes_of(face);
    const FlatTriangle& flat = s.triangles[face];
    const auto apart = [&](int a, int b) {
      return (s.rest.row(nodes[a]) - s.rest.row(nodes[b])).norm();
    };
    CHECK(length(flat.b) == Approx(apart(0, 1)));
    CHECK(length(flat.c) == Approx(apart(0, 2)));
    CHECK(length({flat.c[0] - flat.b[0], flat.c[1] - flat.b[1]}) == Approx(apart(1, 2)));
    CHECK(flat.signed_area() > 0);
  }
}

TEST_CASE("a triangle without a height gets a little of one", "[mesh][surface]") {
  for (const double height : {0.0, 1e-30, 1e-9}) {
    const TriangleSurface s = surface_of({{0, 0, 0}, {0, 0, 2}, {0, height, 0.7}}, {{0, 1, 2}});
    const FlatTriangle& flat = s.triangles[0];
    CHECK(flat.b[1] == 0);  // u runs along the longest edge
    CHECK(flat.b[0] == Approx(2).epsilon(1e-7));
    const double excess = length(flat.c) + length({flat.c[0] - flat.b[0], flat.c[1]}) - flat.b[0];
    CHECK(excess == Approx(2e-8).epsilon(1e-6));
    CHECK(flat.signed_area() > 1e-5);
  }
}

TEST_CASE("coordinates of any size are read, or refused with a reason", "[mesh][surface]") {
  for (const double size : {1e-60, 1e60}) {
    Mesh mesh = square(4, size, 0.2);
    const TriangleSurface s = make_surface(mesh).value();
    CHECK(s.unit[0] == Approx(size));
    CHECK(s.faces_left_out == 0);
  }
  const auto too_large = make_surface(square(4, 1e200, 0.2));
  REQUIRE_FALSE(too_large);
  CHECK_THAT(too_large.error().message, contains_text("area"));
}
