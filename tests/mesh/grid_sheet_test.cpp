#include "pliant/mesh/grid_sheet.hpp"

#include <Eigen/Geometry>

#include "pliant/mesh/grid_mapping.hpp"
#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("a sheet's vertices lie where the format says", "[mesh][grid_sheet]") {
  const Mesh mesh = make_mesh({.columns = 5, .rows = 4, .width = 8, .depth = 3});
  REQUIRE(mesh.vertex_count() == 20);
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 5; ++i) {
      const int vertex = j * 5 + i;
      CHECK(mesh.positions.row(vertex) == Eigen::RowVector3d(2 * i - 4, 0, j - 1.5));
      CHECK(mesh.uvs[vertex] == std::array<double, 2>{i / 4.0, j / 3.0});
    }
  }
}

TEST_CASE("a sheet is its own mirror image to the bit", "[mesh][grid_sheet]") {
  const Mesh mesh = make_mesh({.columns = 62, .rows = 61, .width = 20.1, .depth = 0.3});
  for (int j = 0; j < 61; ++j) {
    for (int i = 0; i < 62; ++i) {
      CHECK(mesh.positions(j * 62 + i, 0) == -mesh.positions(j * 62 + 61 - i, 0));
      CHECK(mesh.positions(j * 62 + i, 2) == -mesh.positions((60 - j) * 62 + i, 2));
    }
  }
}

TEST_CASE("a sheet's faces cover it once and look up", "[mesh][grid_sheet]") {
  const bool triangles = GENERATE(false, true);
  const Mesh mesh =
      make_mesh({.columns = 4, .rows = 6, .width = 2, .depth = 7, .triangles = triangles});
  CHECK(mesh.face_sizes.size() == (triangles ? 30u : 15u));
  double area = 0;
  std::size_t corner = 0;
  for (const int size : mesh.face_sizes) {
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // Newell: twice the area
    for (int k = 0; k < size; ++k) {
      const Eigen::Vector3d a = mesh.positions.row(mesh.corner_vertices[corner + k]).transpose();
      const Eigen::Vector3d b =
          mesh.positions.row(mesh.corner_vertices[corner + (k + 1) % size]).transpose();
      normal += a.cross(b);
    }
    CHECK(normal.y() > 0);
    area += normal.y() / 2;
    corner += static_cast<std::size_t>(size);
  }
  CHECK_THAT(area, pliant::testing::WithinAbs(14, 1e-12));
}

TEST_CASE("a sheet is a grid whose nodes are its vertices", "[mesh][grid_sheet]") {
  const auto mapping = find_grid(make_mesh({.columns = 7, .rows = 3, .width = 2, .depth = 1}));
  REQUIRE(mapping);
  CHECK(mapping->grid == Grid{7, 3, 1.0 / 6, 0.5});
  for (int vertex = 0; vertex < 21; ++vertex) CHECK(mapping->vertex_nodes[vertex] == vertex);
}
