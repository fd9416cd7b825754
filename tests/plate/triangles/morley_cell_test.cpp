#include "pliant/plate/triangles/morley_cell.hpp"

#include <cmath>
#include <random>

#include <Eigen/Dense>

#include "support/catch.hpp"

using namespace pliant;

namespace {

FlatTriangle random_triangle(std::mt19937& random) {
  const auto number = [&] { return static_cast<double>(random()) / 2147483648.0 - 1; };
  for (;;) {
    const FlatTriangle triangle{{number(), number()}, {number(), number()}};
    if (std::abs(triangle.signed_area()) > 0.05) return triangle;
  }
}

// The curvature of the cell for displacements and outward slopes of w = (x y) S (x y)^T / 2.
Curvature curvature_of(const MorleyCell& cell, const FlatTriangle& shape,
                       const Eigen::Matrix2d& s) {
  const Eigen::Vector2d places[] = {{0, 0}, {shape.b[0], shape.b[1]}, {shape.c[0], shape.c[1]}};
  Curvature h = {0, 0, 0};
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector2d middle = 0.5 * (places[k] + places[(k + 1) % 3]);
    const Eigen::Vector2d normal(cell.normals[k][0], cell.normals[k][1]);
    const double w = 0.5 * places[k].dot(s * places[k]), slope = normal.dot(s * middle);
    for (int n = 0; n < 3; ++n) {
      h[n] += cell.by_corner()[k][n] * w + cell.by_slope[k][n] * slope;
    }
  }
  return h;
}

}  // namespace

TEST_CASE("a cell has the curvature of every quadratic, and none of a plane", "[plate][morley]") {
  std::mt19937 random(3);
  for (int trial = 0; trial < 50; ++trial) {
    const FlatTriangle shape = random_triangle(random);  // turns either way
    const MorleyCell cell(shape);
    Eigen::Matrix2d s = Eigen::Matrix2d::Random();
    s(1, 0) = s(0, 1);
    const Curvature h = curvature_of(cell, shape, s);
    CHECK(h[0] == Approx(s(0, 0)).margin(1e-12));
    CHECK(h[1] == Approx(s(1, 1)).margin(1e-12));
    CHECK(h[2] == Approx(s(0, 1)).margin(1e-12));
    // w = x, with its slopes.
    const double w[] = {0, shape.b[0], shape.c[0]};
    for (int n = 0; n < 3; ++n) {
      double sum = 0;
      for (int k = 0; k < 3; ++k) {
        sum += cell.by_corner()[k][n] * w[k] + cell.by_slope[k][n] * cell.normals[k][0];
      }
      CHECK(sum == Approx(0).margin(1e-12));
    }
  }
}

TEST_CASE("the energy's form is positive for every elliptic stiffness", "[plate][morley]") {
  for (const double c : {-3.9, -2.0, 0.0, 2.0, 4.0, 9.0}) {
    const Stiffness stiffness{1, c, 4};
    REQUIRE(stiffness.is_elliptic());
    const Bending form = bending_of(stiffness, {2, 3});
    CHECK(form.uv > 0);
    CHECK(form.uu * form.vv > form.coupling * form.coupling);
    // Without a load the twist and the coupling are c together, whatever Poisson's ratio.
    CHECK(form.uv + 2 * form.coupling == Approx(c * 36));
    CHECK(form.uu == 16);
    CHECK(form.vv == 4 * 81);
  }
  CHECK(bending_of({1, 2, 4}, {1, 1}, 0.3).coupling == Approx(0.6));
}

TEST_CASE("a given slope is that of the side it faces", "[plate][morley]") {
  const MorleyCell cell(FlatTriangle{{2, 0}, {0, 2}});
  const std::array<double, 4> slopes = {1, 10, 100, 1000};
  CHECK(cell.given_slope(0, slopes) == -100);         // towards -v
  CHECK(cell.given_slope(2, slopes) == -1);           // towards -u
  CHECK(cell.given_slope(1, slopes) == Approx(505));  // half along each
  const MorleyCell mirrored(FlatTriangle{{0, 2}, {2, 0}});
  CHECK(mirrored.given_slope(0, slopes) == -1);
  CHECK(mirrored.given_slope(2, slopes) == -100);
}
