#include "pliant/mesh/triangles/triangulate.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <Eigen/Geometry>

#include "pliant/mesh/grid_sheet.hpp"
#include "support/catch.hpp"

using namespace pliant;

namespace {

using Triangles = std::vector<std::array<int, 3>>;

Mesh polygon(const std::vector<std::array<double, 2>>& points) {
  Mesh mesh;
  mesh.positions.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t k = 0; k < points.size(); ++k) {
    mesh.positions.row(static_cast<Eigen::Index>(k)) << points[k][0], 0.5, -points[k][1];
    mesh.corner_vertices.push_back(static_cast<int>(k));
    mesh.corner_uvs.push_back(-1);
  }
  mesh.face_sizes = {static_cast<int>(points.size())};
  return mesh;
}

double area(const Mesh& mesh, const std::array<int, 3>& corners) {
  const auto at = [&](int k) -> Vector3d { return mesh.positions.row(mesh.corner_vertices[k]); };
  return (at(corners[1]) - at(corners[0])).cross(at(corners[2]) - at(corners[0])).y() / 2;
}

}  // namespace

TEST_CASE("convex faces become fans around their first corner", "[mesh][triangulate]") {
  Mesh mesh = make_mesh({.triangles = false});
  CHECK(triangulate(mesh)[0] == std::array{0, 1, 2});
  CHECK(triangulate(mesh)[1] == std::array{0, 2, 3});
  CHECK(triangulate(mesh)[2] == std::array{4, 5, 6});
  CHECK(triangulate(make_mesh({.triangles = true}))[3] == std::array{9, 10, 11});
  CHECK(triangulate(polygon({{1, 0}, {2, 1}, {1.5, 2}, {0.5, 2}, {0, 1}})) ==
        Triangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}});
}

TEST_CASE("faces that are not convex are covered once", "[mesh][triangulate]") {
  // An arrow head, an L and a comb; none of them is a fan around its first corner.
  std::vector<std::array<double, 2>> points = GENERATE(
      std::vector<std::array<double, 2>>{{0, 0}, {2, -2}, {0, 2}, {-2, -2}},
      std::vector<std::array<double, 2>>{{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}},
      std::vector<std::array<double, 2>>{{0, 0},
                                         {5, 0},
                                         {5, 3},
                                         {4, 3},
                                         {4, 1},
                                         {3, 1},
                                         {3, 3},
                                         {2, 3},
                                         {2, 1},
                                         {1, 1},
                                         {1, 3},
                                         {0, 3}});
  std::rotate(points.begin(), points.begin() + GENERATE(0, 1, 2, 3), points.end());
  const Mesh mesh = polygon(points);
  double whole = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto& [x, y] = points[k];
    const auto& [x2, y2] = points[(k + 1) % points.size()];
    whole += (x * y2 - x2 * y) / 2;
  }
  double sum = 0;
  const Triangles triangles = triangulate(mesh);
  CHECK(triangles.size() == points.size() - 2);
  for (const auto& triangle : triangles) {
    CHECK(area(mesh, triangle) > 0);  // none is reversed, so none overlap
    sum += area(mesh, triangle);
  }
  CHECK(sum == whole);
}

TEST_CASE("a face without an area is cut all the same", "[mesh][triangulate]") {
  CHECK(triangulate(polygon({{0, 0}, {1, 0}, {2, 0}, {3, 0}})).size() == 2);
  CHECK(triangulate(polygon({{0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}})).size() == 3);
}

TEST_CASE("faces of many corners are covered once, and those that cross themselves are fans",
          "[mesh][triangulate]") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(0, 1);
  using Points = std::vector<std::array<double, 2>>;
  constexpr int count = 500;
  Points star, comb, steps, frame;
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.9 * share(random)) / count;
    const double way = 0.2 + share(random);
    star.push_back({way * std::cos(angle), way * std::sin(angle)});
  }
  for (int k = 0; k < count; ++k) comb.push_back({2.0 * k, 0});
  for (int k = count; k-- > 0;) comb.insert(comb.end(), {{2 * k + 0.5, 10}, {2 * k - 0.5, 1}});
  steps = {{0, -20}, {count, -20}};  // with corners above each other and in one line
  for (int k = count; k-- > 0;) {
    const double height = std::floor(9 * share(random));
    steps.insert(steps.end(), {{k + 1.0, height}, {k + 0.5, height}, {double(k), height}});
  }
  for (int side = 0; side < 4; ++side) {
    for (int k = 0; k < count; ++k) {
      const double a = side < 2 ? k : count - k, b = side == 1 || side == 2 ? count : 0;
      frame.push_back(side % 2 == 0 ? std::array{a, b} : std::array{b, a});
    }
  }
  for (const Points& points : {star, comb, steps, frame}) {
    for (const double turn : {0.0, 0.5, 1.0, 2.0}) {
      Points turned;
      const double s = std::sin(turn * std::numbers::pi), c = std::cos(turn * std::numbers::pi);
      for (const auto& [x, y] : points) turned.push_back({c * x - s * y, s * x + c * y});
      const Mesh mesh = polygon(turned);
      const Triangles triangles = triangulate(mesh);
      CHECK(triangles.size() == points.size() - 2);
      double whole = 0, sum = 0, least = 0;
      for (std::size_t k = 0; k < turned.size(); ++k) {
        const auto& [x, y] = turned[k];
        const auto& [x2, y2] = turned[(k + 1) % turned.size()];
        whole += (x * y2 - x2 * y) / 2;
      }
      for (const auto& triangle : triangles) {
        sum += area(mesh, triangle);
        least = std::min(least, area(mesh, triangle));
      }
      CHECK(least >= -1e-9 * whole);  // none is reversed, but for rounding
      CHECK_THAT(sum, Catch::Matchers::WithinRel(whole, 1e-9));
    }
  }
  Points knot;
  for (int k = 0; k < 99; ++k)
    knot.push_back(
        {std::cos(k * 40 * std::numbers::pi / 99), std::sin(k * 46 * std::numbers::pi / 99)});
  const Triangles fan = triangulate(polygon(knot));
  REQUIRE(fan.size() == 97);
  CHECK(fan[0] == std::array{0, 1, 2});
  CHECK(fan[96] == std::array{0, 97, 98});
}
