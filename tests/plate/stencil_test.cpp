#include "pliant/plate/stencil.hpp"

#include <cmath>

#include "support/catch.hpp"
#include "support/plates.hpp"

using namespace pliant;
using pliant::testing::apply_stencil;
using pliant::testing::sampled;
using pliant::testing::unit_grid;
using pliant::testing::WithinAbs;

namespace {

// The n-th derivative of x^p.
double derivative(int p, int n, double x) {
  double factor = 1;
  for (int k = 0; k < n; ++k) factor *= p - k;
  return p < n ? 0 : factor * std::pow(x, p - n);
}

}  // namespace

TEST_CASE("the stencil is exact on polynomials up to degree 5", "[plate][stencil]") {
  // Each difference has an error of order h^2 in the derivative two orders higher: 0 up to degree
  // 5.
  const Grid grid{9, 8, 0.25, 0.5};
  const Stiffness stiffness{1.5, -0.7, 2.5};
  for (int p = 0; p <= 5; ++p) {
    for (int q = 0; q + p <= 5; ++q) {
      CAPTURE(p, q);
      const Field w =
          sampled(grid, [&](double u, double v) { return std::pow(u, p) * std::pow(v, q); });
      const Field lw = apply_stencil(grid, stiffness, {}, w);
      for (int j = 2; j <= grid.rows - 3; ++j) {  // no ghost in the stencil
        for (int i = 2; i <= grid.columns - 3; ++i) {
          const double u = i * grid.hu, v = j * grid.hv;
          const double exact = stiffness.b * derivative(p, 4, u) * derivative(q, 0, v) +
                               stiffness.c * derivative(p, 2, u) * derivative(q, 2, v) +
                               stiffness.d * derivative(p, 0, u) * derivative(q, 4, v);
          // Values up to 2^5 over h^4 = 1/256, 13 terms: 32 x 256 x 13 x eps.
          CHECK_THAT(lw((j - 1) * (grid.columns - 2) + i - 1, 0), WithinAbs(exact, 3e-11));
        }
      }
    }
  }
}

TEST_CASE("the stencil's error beyond degree 5 is h^2/6 times the sixth derivative",
          "[plate][stencil]") {
  const Grid grid{7, 7, 0.25, 0.25};
  const Field w = sampled(grid, [](double u, double) { return std::pow(u, 6); });
  const double at_centre = apply_stencil(grid, {1, 0, 1}, {}, w)(2 * 5 + 2, 0);
  const double u = 3 * 0.25;
  CHECK_THAT(at_centre - 360 * u * u, WithinAbs(0.25 * 0.25 / 6 * 720, 1e-10));
}

TEST_CASE("ghost nodes with tangents are exact up to degree 2", "[plate][stencil]") {
  // w = p(u) q(v) of degree 2 in each: fourth differences are 0 exactly if the ghosts are right.
  const Grid grid = GENERATE(Grid{3, 3, 0.5, 0.25}, Grid{4, 3, 0.5, 0.25}, Grid{5, 9, 0.25, 0.125});
  const double width = (grid.columns - 1) * grid.hu, depth = (grid.rows - 1) * grid.hv;
  const Stiffness stiffness{1.5, 0.75, 2.5};
  SECTION("along u") {
    const Field w = sampled(grid, [](double u, double) { return 1 + 2 * u - 3 * u * u; });
    EdgeTangents tangents;
    tangents.su0.setConstant(2);
    tangents.su1.setConstant(2 - 6 * width);
    CHECK(apply_stencil(grid, stiffness, tangents, w).cwiseAbs().maxCoeff() < 1e-10);
    tangents.su1.setConstant(0);
    CHECK(apply_stencil(grid, stiffness, tangents, w).cwiseAbs().maxCoeff() > 1);
  }
  SECTION("along v") {
    const Field w = sampled(grid, [](double, double v) { return 1 - v + 4 * v * v; });
    EdgeTangents tangents;
    tangents.sv0.setConstant(-1);
    tangents.sv1.setConstant(-1 + 8 * depth);
    CHECK(apply_stencil(grid, stiffness, tangents, w).cwiseAbs().maxCoeff() < 1e-9);
    tangents.sv0.setConstant(0);
    CHECK(apply_stencil(grid, stiffness, tangents, w).cwiseAbs().maxCoeff() > 1);
  }
}

TEST_CASE("each tangent acts beside its own edge, in its own component", "[plate][stencil]") {
  const Grid grid{6, 5, 0.5, 0.25};
  const Stiffness stiffness{2, 3, 5};
  const Field zero = Field::Zero(grid.node_count(), 3);
  const int edge = GENERATE(0, 1, 2, 3);
  const int component = GENERATE(0, 1, 2);
  EdgeTangents tangents;
  Vector3d* const edges[] = {&tangents.su0, &tangents.su1, &tangents.sv0, &tangents.sv1};
  (*edges[edge])[component] = 7;
  const Field lw = apply_stencil(grid, stiffness, tangents, zero);
  // Eq. (6): -+ 2 h s at the ghost, weighed by b/hu^4 or d/hv^4.
  const double along_u = 2 * 2 * 7 / std::pow(0.5, 3), along_v = 5 * 2 * 7 / std::pow(0.25, 3);
  for (int j = 1; j <= 3; ++j) {
    for (int i = 1; i <= 4; ++i) {
      const double expected[] = {i == 1 ? -along_u : 0, i == 4 ? along_u : 0, j == 1 ? -along_v : 0,
                                 j == 3 ? along_v : 0};
      for (int k = 0; k < 3; ++k) {
        CHECK(lw((j - 1) * 4 + i - 1, k) == (k == component ? expected[edge] : 0));
      }
    }
  }
}
