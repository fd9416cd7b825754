#include "pliant/mesh/grid_mapping.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "pliant/mesh/grid_sheet.hpp"
#include "support/catch.hpp"
#include "support/sanitized.hpp"

using namespace pliant;
using Catch::Matchers::Contains;
using pliant::testing::WithinAbs;

namespace {

Mesh sheet() { return make_mesh({.columns = 9, .rows = 6, .width = 8, .depth = 5}); }

// The mesh with vertex k renamed to order[k].
Mesh reordered(const Mesh& mesh, const std::vector<int>& order) {
  Mesh result = mesh;
  for (int vertex = 0; vertex < mesh.vertex_count(); ++vertex) {
    result.positions.row(order[vertex]) = mesh.positions.row(vertex);
  }
  for (int& vertex : result.corner_vertices) vertex = order[vertex];
  return result;
}

std::string complaint(const Mesh& mesh) {
  const auto mapping = find_grid(mesh);
  return mapping ? "none" : mapping.error().message;
}

}  // namespace

TEST_CASE("the grid is found in any order of the vertices", "[mesh][grid_mapping]") {
  const Mesh mesh = sheet();
  const GridMapping expected = find_grid(mesh).value();
  std::vector<int> order(mesh.vertex_count());
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(2);
  for (int trial = 0; trial < 10; ++trial) {
    std::shuffle(order.begin(), order.end(), random);
    const auto mapping = find_grid(reordered(mesh, order));
    REQUIRE(mapping);
    CHECK(mapping->grid == expected.grid);
    CHECK(mapping->rest == expected.rest);
    for (int vertex = 0; vertex < mesh.vertex_count(); ++vertex) {
      CHECK(mapping->vertex_nodes[order[vertex]] == expected.vertex_nodes[vertex]);
    }
  }
}

TEST_CASE("any range of (u,v) makes a grid, with its own spacings", "[mesh][grid_mapping]") {
  Mesh mesh = sheet();
  for (auto& [u, v] : mesh.uvs) u = -3 + 0.25 * u, v = 100 + 40 * v;
  const Grid grid = find_grid(mesh).value().grid;
  CHECK(grid.columns == 9);
  CHECK(grid.rows == 6);
  CHECK_THAT(grid.hu, WithinAbs(0.25 / 8, 1e-15));
  CHECK_THAT(grid.hv, WithinAbs(8, 1e-12));
}

TEST_CASE("uneven (u,v) count as even up to a hundredth of the spacing", "[mesh][grid_mapping]") {
  // The corners of the lattice are not moved, so that its extent is the same.
  Mesh mesh = sheet();
  const double hu = 1.0 / 8;
  mesh.uvs[22][0] += 0.0099 * hu;
  CHECK(find_grid(mesh));
  mesh.uvs[22][0] += 0.0002 * hu;
  CHECK_THAT(complaint(mesh), Contains("vertex 22 has u = "));
}

TEST_CASE("vertices of one node move together", "[mesh][grid_mapping]") {
  // A copy of vertex 13, as made by an exporter that splits vertices by normal, used by one face.
  Mesh mesh = sheet();
  const int copy = mesh.vertex_count();
  mesh.positions.conservativeResize(copy + 1, 3);
  mesh.positions.row(copy) = mesh.positions.row(13);
  *std::find(mesh.corner_vertices.begin(), mesh.corner_vertices.end(), 13) = copy;
  const auto mapping = find_grid(mesh);
  REQUIRE(mapping);
  CHECK(mapping->vertex_nodes[copy] == mapping->vertex_nodes[13]);

  mesh.positions(copy, 1) += 1e-9;
  CHECK_THAT(complaint(mesh),
             Contains("vertices 13 and 54 share") && Contains("not the rest position"));
}

TEST_CASE("what is no even grid is refused, with what is needed", "[mesh][grid_mapping]") {
  Mesh mesh = sheet();
  std::string expected;
  SECTION("a seam") {
    // Vertex 2 is a corner of two faces; in the second it gets the (u,v) of another node.
    mesh.corner_uvs[4] = 40;
    REQUIRE(mesh.corner_vertices[4] == 1);
    CHECK_THAT(complaint(mesh), Contains("vertex 1 has several (u,v)") && Contains(": a seam"));
    return;
  }
  SECTION("a corner without (u,v)") {
    mesh.corner_uvs[7] = -1;
    CHECK_THAT(complaint(mesh), Contains(" has no (u,v) (UVs); 1 of the 160 corners"));
    mesh.corner_uvs.assign(mesh.corner_uvs.size(), -1);
    CHECK_THAT(complaint(mesh), Contains("the mesh has no (u,v) (UVs); unwrap it"));
    return;
  }
  SECTION("a loose vertex") {
    mesh.positions.conservativeResize(55, 3);
    mesh.positions.row(54).setZero();
    CHECK_THAT(complaint(mesh), Contains("vertex 54 has no (u,v): no face uses it"));
    return;
  }
  SECTION("all (u,v) alike") {
    for (auto& uv : mesh.uvs) uv = {0.5, 0.5};
    expected = "1 x 1 nodes";
  }
  SECTION("irregular (u,v)") {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> unit(0, 1);
    for (auto& [u, v] : mesh.uvs) u = unit(random), v = unit(random);
    expected = "even lattice";
  }
  SECTION("graded (u,v)") {
    for (auto& [u, v] : mesh.uvs) u *= u;
    expected = "even lattice";
  }
  SECTION("an empty node") {
    // Node (4,2) becomes empty: its vertex moves to the neighbouring node, which it then shares.
    mesh.uvs[22] = mesh.uvs[23];
    mesh.positions.row(22) = mesh.positions.row(23);
    mesh.uvs.push_back({0, 0});
    expected = "there is no vertex at (u,v) = (0.5, 0.4), node (4, 2)";
    // One more vertex, so that the number of vertices does not reveal the error.
    mesh.positions.conservativeResize(55, 3);
    mesh.positions.row(54) = mesh.positions.row(23);
    mesh.face_sizes.push_back(3);
    mesh.corner_vertices.insert(mesh.corner_vertices.end(), {54, 0, 1});
    mesh.corner_uvs.insert(mesh.corner_uvs.end(), {23, 0, 1});
  }
  SECTION("too few vertices") {
    mesh.uvs[22] = mesh.uvs[23];
    mesh.positions.row(22) = mesh.positions.row(23);
    for (auto& uv : mesh.uvs) uv[0] = uv[0] == 1 ? 1 + 1.0 / 8 : uv[0];  // a column is missing
    expected = "";
  }
  CHECK_THAT(complaint(mesh), Contains(expected));
}

TEST_CASE("extreme (u,v) of a second corner are no harm", "[mesh][grid_mapping]") {
  Mesh mesh = sheet();
  mesh.uvs.push_back({1e300, -1e300});
  mesh.corner_uvs.back() = static_cast<int>(mesh.uvs.size()) - 1;
  CHECK_THAT(complaint(mesh), Contains("several (u,v)"));
  mesh.uvs[13] = {1e308, -1e308};
  mesh.uvs[14] = {-1e308, 1e308};
  CHECK(complaint(mesh) != "none");
}

namespace {

// A torus of 9 x 6 nodes, opened by `gap` [length] along u and v.
Mesh torus(double gap) {
  Mesh mesh = sheet();
  const double turn = 2 * std::acos(-1.0);
  for (int vertex = 0; vertex < mesh.vertex_count(); ++vertex) {
    const double a = turn * (vertex % 9) / 8, b = turn * (vertex / 9) / 5;
    const double x = vertex % 9 == 8 ? gap : 0, y = vertex / 9 == 5 ? gap : 0;
    mesh.positions.row(vertex) << (3 + std::cos(b)) * std::cos(a) + 7, std::sin(b) + y,
        (3 + std::cos(b)) * std::sin(a) + x;
  }
  return mesh;
}

}  // namespace

TEST_CASE("vertices in one place with other (u,v) are a seam", "[mesh][grid_mapping]") {
  const double diagonal = std::sqrt(8.0 * 8 + 2 * 2 + 8 * 8);
  // Rounding leaves the ends of the torus 1e-15 apart.
  CHECK_THAT(complaint(torus(0)),
             Contains(" are at the same position, but have the (u,v) (0, 0) and (") &&
                 Contains(": a seam"));
  CHECK_THAT(complaint(torus(0.9e-6 * diagonal)), Contains(": a seam"));
  CHECK(complaint(torus(1.2e-6 * diagonal)) == "none");

  Mesh folded = sheet();  // inside, only exactly equal positions are one place
  folded.positions.row(31) = folded.positions.row(21);
  CHECK_THAT(complaint(folded), Contains("vertices 21 and 31 are at the same position"));
  folded.positions(31, 1) += 1e-12;
  CHECK(complaint(folded) == "none");
  folded.positions.row(21) << 0.0, 0.0, 0.0;
  folded.positions.row(31) << -0.0, 0.0, -0.0;
  CHECK_THAT(complaint(folded), Contains("are at the same position"));
}

TEST_CASE("a seam is found wherever cells of the search divide", "[mesh][grid_mapping]") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int trial = 0; trial < 300; ++trial) {
    Mesh mesh = sheet();
    const double diagonal = std::sqrt(8.0 * 8 + 5 * 5);
    mesh.positions.col(0).array() += 1000 * unit(random);
    Eigen::RowVector3d away(unit(random) - 0.5, 0, unit(random) - 0.5);
    away *= (trial % 2 == 0 ? 0.99e-6 : 1.01e-6) * diagonal / away.norm();
    mesh.positions.row(20 + 9 - 2) = mesh.positions.row(18) + away;  // both in the first column
    CHECK((complaint(mesh) == "none") == (trial % 2 == 1));
  }
}

TEST_CASE("a mesh whose nodes all lie in one place takes no time", "[mesh][grid_mapping]") {
  const int side = testing::is_sanitized ? 200 : 1000;
  Mesh mesh = make_mesh({.columns = side, .rows = side});
  mesh.positions.setZero();
  CHECK_THAT(complaint(mesh), Contains("vertices 0 and 1 are at the same position"));
}

namespace {

std::string complaint(const Mesh& mesh, Wrap wrap) {
  const auto mapping = find_grid(mesh, wrap);
  return mapping ? "none" : mapping.error().message;
}

// A tube about y of `columns` x `rows` nodes. The vertices of its seam are there twice, or once and
// then have the (u,v) of both ends.
Mesh tube(int columns, int rows, bool is_split) {
  Mesh mesh = make_mesh({.columns = columns + 1, .rows = rows});
  const double turn = 2 * std::acos(-1.0);
  for (int vertex = 0; vertex < mesh.vertex_count(); ++vertex) {
    const int i = vertex % (columns + 1), j = vertex / (columns + 1);
    const double angle = turn * (i % columns) / columns;
    mesh.positions.row(vertex) << std::cos(angle), j, std::sin(angle);
  }
  if (is_split) return mesh;
  Field kept(columns * rows, 3);
  const auto vertex_of = [&](int vertex) {
    const int i = vertex % (columns + 1), j = vertex / (columns + 1);
    return j * columns + i % columns;
  };
  for (int vertex = 0; vertex < mesh.vertex_count(); ++vertex)
    kept.row(vertex_of(vertex)) = mesh.positions.row(vertex);
  for (int& vertex : mesh.corner_vertices) vertex = vertex_of(vertex);
  mesh.positions = kept;
  return mesh;
}

}  // namespace

TEST_CASE("wrap makes the first and the last column one", "[mesh][grid_mapping][closed]") {
  for (const bool is_split : {true, false}) {
    const Mesh mesh = tube(7, 5, is_split);
    CHECK_THAT(complaint(mesh), Contains(": a seam"));
    const GridMapping mapping = find_grid(mesh, Wrap::U).value();
    CHECK(mapping.grid == Grid{7, 5, 1.0 / 7, 0.25, true, false});
    REQUIRE(mapping.rest.rows() == 35);
    const int stride = is_split ? 8 : 7;
    for (int vertex = 0; vertex < mesh.vertex_count(); ++vertex) {
      const int i = vertex % stride % 7, j = vertex / stride;
      CHECK(mapping.vertex_nodes[vertex] == j * 7 + i);
      CHECK(mapping.rest.row(j * 7 + i) == mesh.positions.row(vertex));
    }
    std::vector<int> order(mesh.vertex_count());
    std::iota(order.begin(), order.end(), 0);
    std::mt19937 random(3);
    for (int trial = 0; trial < 5; ++trial) {
      std::shuffle(order.begin(), order.end(), random);
      const GridMapping other = find_grid(reordered(mesh, order), Wrap::U).value();
      CHECK(other.grid == mapping.grid);
      CHECK(other.rest == mapping.rest);
    }
    // Its other direction is open.
    CHECK_THAT(complaint(mesh, Wrap::UV), Contains("wrap makes them one node"));
  }
}

TEST_CASE("a tube that is cut keeps the two sides of its cut apart if that is asked for",
          "[mesh][grid_mapping][closed]") {
  const Mesh mesh = tube(7, 5, true);
  const GridMapping mapping = find_grid(mesh, Wrap::None, Seams::Open).value();
  CHECK(mapping.grid == Grid{8, 5, 1.0 / 7, 0.25, false, false});
  for (int vertex = 0; vertex < mesh.vertex_count(); ++vertex) {
    CHECK(mapping.vertex_nodes[vertex] == vertex);
    CHECK(mapping.rest.row(vertex) == mesh.positions.row(vertex));
  }
  // One vertex cannot be two nodes.
  const auto whole = find_grid(tube(7, 5, false), Wrap::None, Seams::Open);
  REQUIRE_FALSE(whole);
  CHECK_THAT(whole.error().message, Contains("has several (u,v)"));
  CHECK(find_grid(torus(0), Wrap::U, Seams::Open)->grid == Grid{8, 6, 0.125, 0.2, true, false});
}

TEST_CASE("a torus is closed along both", "[mesh][grid_mapping][closed]") {
  const double diagonal = std::sqrt(8.0 * 8 + 2 * 2 + 8 * 8);
  for (const double gap : {0.0, 0.7e-6 * diagonal}) {  // in two directions at a corner
    const auto mapping = find_grid(torus(gap), Wrap::UV);
    REQUIRE(mapping);
    CHECK(mapping->grid == Grid{8, 5, 0.125, 0.2, true, true});
  }
  CHECK_THAT(complaint(torus(1.1e-6 * diagonal), Wrap::UV),
             Contains("vertices 0 and 8, with the (u,v) (0, 0) and (1, 0), are ") &&
                 Contains("1e-6 of the bounding box's diagonal"));
  // Closed along one of them only it still meets itself.
  CHECK_THAT(complaint(torus(0), Wrap::U), Contains(": a seam"));
  CHECK_THAT(complaint(torus(0), Wrap::V), Contains(": a seam"));
}

TEST_CASE("what no closed grid can be is refused", "[mesh][grid_mapping][closed]") {
  SECTION("an open sheet") {
    CHECK_THAT(complaint(sheet(), Wrap::U),
               Contains("vertices 0 and 8, with the (u,v) (0, 0) and (1, 0), are 8 apart"));
    CHECK_THAT(complaint(sheet(), Wrap::V), Contains("vertices 0 and 45, with the (u,v) "));
  }
  SECTION("fewer than 3 columns") {
    CHECK(complaint(tube(3, 3, true), Wrap::U) == "none");
    CHECK_THAT(complaint(tube(2, 3, true), Wrap::U), Contains("a closed grid of 2 x 3 nodes"));
  }
  SECTION("a pole") {
    const bool is_split = GENERATE(true, false);
    Mesh mesh = tube(7, 5, is_split);
    const int stride = is_split ? 8 : 7;
    for (int i = 0; i < stride; ++i)
      mesh.positions.row(4 * stride + i) = Eigen::RowVector3d(0, 5, 0);
    CHECK_THAT(complaint(mesh, Wrap::U),
               Contains("row 4 of the grid, with vertices ") && Contains(": a pole"));
  }
  SECTION("a pole of one vertex") {
    Mesh mesh = tube(7, 5, false);
    for (int& vertex : mesh.corner_vertices) vertex = vertex >= 28 ? 28 : vertex;
    mesh.positions.conservativeResize(29, 3);
    CHECK_THAT(complaint(mesh, Wrap::U), Contains("vertex 28 has several (u,v)"));
  }
  SECTION("a vertex with (u,v) of two columns") {
    Mesh mesh = tube(7, 5, false);
    mesh.corner_uvs[0] = 3;
    CHECK_THAT(complaint(mesh, Wrap::U), Contains("has several (u,v)"));
  }
}
