#include "viewer/coarse_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

#include <Eigen/Geometry>

#include "support/catch.hpp"

namespace {

using namespace pliant;
using pliant::viewer::coarse_mesh;
using pliant::viewer::CoarseMesh;

struct Flat {
  Field positions;
  std::vector<std::uint32_t> triangles;
};

// A flat grid of squares in the plane z = 0, `side` vertices along each side, which is `size` long.
Flat flat_grid(int side, double size, const Vector3d& origin = Vector3d::Zero()) {
  Flat flat;
  flat.positions.resize(side * side, 3);
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * side + i); };
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      flat.positions.row(at(i, j)) =
          (origin + Vector3d(size * i / (side - 1), size * j / (side - 1), 0)).transpose();
      if (i + 1 == side || j + 1 == side) continue;
      for (const std::uint32_t corner :
           {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1)})
        flat.triangles.push_back(corner);
    }
  }
  return flat;
}

// The area vectors of the triangles.
std::vector<Vector3d> areas(const Flat& flat, const CoarseMesh& coarse) {
  std::vector<Vector3d> all;
  const auto corner = [&](std::size_t k) -> Vector3d {
    return flat.positions.row(coarse.vertices[coarse.triangles[k]]).transpose();
  };
  for (std::size_t k = 0; k < coarse.triangles.size(); k += 3)
    all.push_back(0.5 * (corner(k + 1) - corner(k)).cross(corner(k + 2) - corner(k)));
  return all;
}

void check_valid(const Flat& flat, const CoarseMesh& coarse, int most) {
  CHECK(coarse.vertices.size() <= static_cast<std::size_t>(most));
  CHECK(std::is_sorted(coarse.vertices.begin(), coarse.vertices.end()));
  CHECK(std::adjacent_find(coarse.vertices.begin(), coarse.vertices.end()) ==
        coarse.vertices.end());
  for (const int vertex : coarse.vertices) CHECK((vertex >= 0 && vertex < flat.positions.rows()));
  std::set<std::array<std::uint32_t, 3>> seen;
  REQUIRE(coarse.triangles.size() % 3 == 0);
  for (std::size_t k = 0; k < coarse.triangles.size(); k += 3) {
    std::array<std::uint32_t, 3> corners = {coarse.triangles[k], coarse.triangles[k + 1],
                                            coarse.triangles[k + 2]};
    std::sort(corners.begin(), corners.end());
    CHECK(corners[2] < coarse.vertices.size());
    CHECK((corners[0] != corners[1] && corners[1] != corners[2]));
    CHECK(seen.insert(corners).second);
  }
}

}  // namespace

TEST_CASE("a mesh that is small enough stays as it is", "[view][coarse]") {
  const Flat flat = flat_grid(7, 3);
  const CoarseMesh coarse = coarse_mesh(flat.positions, flat.triangles, 49);
  CHECK(coarse.vertices.size() == 49);
  CHECK(coarse.triangles == flat.triangles);
}

TEST_CASE("a coarser mesh covers the surface with its orientation", "[view][coarse]") {
  const int most = GENERATE(8, 50, 333, 2000, 3000);
  const double size = GENERATE(1e-9, 12.0, 1e12);
  CAPTURE(most, size);
  const Flat flat = flat_grid(61, size, size * Vector3d(-7, 3, 5));
  const CoarseMesh coarse = coarse_mesh(flat.positions, flat.triangles, most);
  check_valid(flat, coarse, most);
  // Cubes are as small as they can be: with n along a side there are n^2, and (n + 1)^2 > most.
  CHECK(coarse.vertices.size() >= static_cast<std::size_t>(most) / 4);
  double covered = 0;
  for (const Vector3d& area : areas(flat, coarse)) {
    CHECK(area[2] >= 0);
    covered += area[2];
  }
  // At the border up to half a cube is missing on each side, and vertices have some freedom in
  // their cubes.
  const double side = 1 - 1.5 / std::sqrt(static_cast<double>(coarse.vertices.size()));
  CHECK(covered <= (1 + 1e-9) * size * size);
  CHECK(covered >= side * side * size * size);
}

TEST_CASE("meshes without an extent or triangles are made coarser too", "[view][coarse]") {
  Flat flat = flat_grid(9, 1);
  SECTION("all vertices in one place") {
    flat.positions.setConstant(3.5);
    const CoarseMesh coarse = coarse_mesh(flat.positions, flat.triangles, 20);
    check_valid(flat, coarse, 20);
    CHECK(coarse.vertices.size() == 1);
  }
  SECTION("no triangle") {
    const CoarseMesh coarse = coarse_mesh(flat.positions, {}, 20);
    check_valid(flat, coarse, 20);
    CHECK(coarse.vertices.size() >= 9);
  }
  SECTION("as large as numbers are") {
    flat.positions *= 1e308;
    flat.positions.rowwise() -= Eigen::RowVector3d(0.9e308, 0.9e308, 0);
    const CoarseMesh coarse = coarse_mesh(flat.positions, flat.triangles, 20);
    check_valid(flat, coarse, 20);
    CHECK(coarse.vertices.size() >= 9);
  }
}

TEST_CASE("one far vertex costs detail, and no time without end", "[view][coarse]") {
  Flat flat = flat_grid(20, 1);
  flat.positions.row(399) = Eigen::RowVector3d(1e9, 0, 0);
  const CoarseMesh coarse = coarse_mesh(flat.positions, flat.triangles, 100);
  check_valid(flat, coarse, 100);
  CHECK(std::count(coarse.vertices.begin(), coarse.vertices.end(), 399) == 1);
}
