#include "pliant/mesh/mesh.hpp"

#include <limits>

#include "pliant/mesh/grid_sheet.hpp"
#include "support/catch.hpp"

using namespace pliant;
using Catch::Matchers::Contains;

TEST_CASE("a mesh that a program made is checked", "[mesh]") {
  Mesh mesh = make_mesh({});
  CHECK(check_mesh(mesh));
  std::string expected;
  SECTION("faces") {
    mesh.face_sizes.clear();
    expected = "no faces";
  }
  SECTION("corners of a face") {
    mesh.face_sizes[1] = 2;
    expected = "face 1 has 2";
  }
  SECTION("number of corners") {
    mesh.face_sizes.push_back(3);
    expected = "19 corners";
  }
  SECTION("uvs of corners") {
    mesh.corner_uvs.pop_back();
    expected = "15 corner uvs";
  }
  SECTION("vertex too large") {
    mesh.corner_vertices[3] = 9;
    expected = "corner 3 refers to vertex 9, but there are 9";
  }
  SECTION("vertex negative") {
    mesh.corner_vertices[3] = -1;
    expected = "vertex -1, but there are 9";
  }
  SECTION("uv too large") {
    mesh.corner_uvs[5] = 9;
    expected = "corner 5 refers to uv 9, but there are 9";
  }
  SECTION("position") {
    mesh.positions(4, 1) = std::numeric_limits<double>::quiet_NaN();
    expected = "vertex 4 has a coordinate";
  }
  SECTION("uv") {
    mesh.uvs[2][1] = std::numeric_limits<double>::infinity();
    expected = "uv 2 is";
  }
  SECTION("number of normals") {
    mesh.corner_normals = {0, 1};
    expected = "16 corners, but there are 2 corner normals";
  }
  SECTION("a normal too large") {
    mesh.corner_normals.assign(16, 0);
    mesh.corner_normals[3] = 16;
    expected = "corner 3 has the normal 16, but there are 16 at most";
  }
  SECTION("a normal of nobody") {
    mesh.corner_normals.assign(16, 2);
    mesh.corner_normals[3] = 0;
    expected = "no corner uses the normal 1 of 3";
  }
  SECTION("number of materials") {
    mesh.materials = {{"a"}, {0, 0}};
    expected = "the list of face materials has 2 entries, but the mesh has 4 faces";
  }
  SECTION("a group too large") {
    mesh.groups = {{"a"}, {0, -1, 1, 0}};
    expected = "face 2 refers to group 1, but there are 1";
  }
  SECTION("numbers of vertices") {
    mesh.file_vertices = {4, 5};
    expected = "the list of vertex numbers has 2 entries, but the mesh has 9 vertices";
  }
  const auto checked = check_mesh(mesh);
  REQUIRE_FALSE(checked);
  CHECK_THAT(checked.error().message, Contains(expected));
}

TEST_CASE("messages count as the file of a mesh does", "[mesh]") {
  Mesh mesh = make_mesh({});
  mesh.positions(4, 1) = std::numeric_limits<double>::quiet_NaN();
  CHECK_THAT(check_mesh(mesh).error().message, Contains("vertex 4 has a coordinate"));
  mesh.first_index = 1;
  CHECK_THAT(check_mesh(mesh).error().message, Contains("vertex 5 has a coordinate"));
  mesh.file_vertices = {20, 21, 22, 23, 24, 25, 26, 27, 28};
  CHECK_THAT(check_mesh(mesh).error().message, Contains("vertex 25 has a coordinate"));
  mesh.corner_vertices[3] = 9;
  CHECK_THAT(check_mesh(mesh).error().message, Contains("corner 4 refers to vertex 10"));
}
