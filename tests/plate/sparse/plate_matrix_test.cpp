#include <cmath>

#include "support/catch.hpp"
#include "support/dense.hpp"
#include "support/plates.hpp"

using namespace pliant;
using pliant::testing::assemble_upper;
using pliant::testing::dense_operator;
using pliant::testing::eigenvalues_of;
using pliant::testing::residual;
using pliant::testing::unit_grid;
using pliant::testing::WithinAbs;
using pliant::testing::WithinRel;

TEST_CASE("the assembled matrix is the stencil's", "[plate][operator]") {
  const Grid grid = GENERATE(Grid{3, 3, 0.5, 0.25}, Grid{4, 3, 0.5, 0.25}, Grid{3, 5, 0.5, 0.25},
                             Grid{4, 4, 0.5, 0.25}, Grid{8, 6, 0.125, 0.5}, Grid{5, 11, 1, 2});
  const PlateSystem system{grid, {1.5, -0.7, 2.25}, 3};
  const Eigen::MatrixXd dense = dense_operator(system);
  const Eigen::MatrixXd upper = assemble_upper(system);
  const double scale = dense.cwiseAbs().maxCoeff();
  CHECK((upper - Eigen::MatrixXd(dense.triangularView<Eigen::Upper>())).cwiseAbs().maxCoeff() <
        1e-15 * scale);
  CHECK((dense - dense.transpose()).cwiseAbs().maxCoeff() < 1e-15 * scale);
}

TEST_CASE("the operator is positive definite down to c near -2 sqrt(bd)", "[plate][operator]") {
  const double b = GENERATE(1.0, 100.0, 0.01);
  const double shortfall = GENERATE(1.0, 1e-3, 1e-9);
  const double c = -2 * std::sqrt(b) * (1 - shortfall);
  const Eigen::MatrixXd dense = dense_operator({unit_grid(11, 9), {b, c, 1}, 0});
  CHECK(eigenvalues_of(dense).minCoeff() > 0);
}

TEST_CASE("the one unknown of a 3 x 3 region has (8b + 4c + 8d)/h^4", "[plate][operator]") {
  const double h = 0.25;
  const Stiffness s{1.25, 2.5, 3.75};
  const SparseMatrix matrix = assemble_upper({Grid{3, 3, h, h}, s, 0});
  REQUIRE(matrix.rows() == 1);
  CHECK(matrix.coeff(0, 0) == (8 * s.b + 4 * s.c + 8 * s.d) / (h * h * h * h));
}

TEST_CASE("the first natural frequency of the clamped square plate is 35.985",
          "[plate][operator]") {
  // omega^2 is the smallest eigenvalue; its error is O(h^2), which one extrapolation removes.
  const auto frequency = [](int nodes) {
    const Eigen::MatrixXd dense = dense_operator({unit_grid(nodes, nodes), {1, 2, 1}, 0});
    return std::sqrt(eigenvalues_of(dense)[0]);
  };
  const double coarse = frequency(11), fine = frequency(21);
  CHECK_THAT(fine + (fine - coarse) / 3, WithinRel(35.985, 2e-3));  // the remaining error is O(h^4)
  CHECK(std::abs(fine - 35.985) < std::abs(coarse - 35.985) / 3.5);
}

TEST_CASE("swapping u with v and b with d permutes the operator", "[plate][operator]") {
  const Grid grid{6, 5, 0.5, 0.25};
  const Grid swapped{5, 6, 0.25, 0.5};
  const Eigen::MatrixXd a = dense_operator({grid, {1.5, 0.5, 2.5}, 1});
  const Eigen::MatrixXd b = dense_operator({swapped, {2.5, 0.5, 1.5}, 1});
  const auto mirrored = [](int k) { return (k % 4) * 3 + k / 4; };  // 4 x 3 unknowns, and 3 x 4
  for (int row = 0; row < 12; ++row) {
    for (int column = 0; column < 12; ++column) {
      CHECK_THAT(a(row, column), WithinAbs(b(mirrored(row), mirrored(column)), 1e-10));
    }
  }
}

TEST_CASE("the residual is that of the matrix", "[plate][operator]") {
  const Grid grid = GENERATE(Grid{3, 3, 0.5, 0.25}, Grid{4, 7, 0.5, 0.25}, Grid{9, 5, 0.125, 0.5});
  const PlateSystem system{grid, {1.5, -0.7, 2.25}, 3};
  const Field w = Field::Random(unknown_count(grid), 3), f = Field::Random(unknown_count(grid), 3);
  const Eigen::MatrixXd A = dense_operator(system);
  CHECK((residual(system, w, f) - (f - A * w)).cwiseAbs().maxCoeff() < 1e-14 * A.norm());
}

TEST_CASE("the residual has digits left where double has none", "[plate][operator]") {
  // f is the rounded product of A with w: the residual is just the rounding error of f.
  const Grid grid = unit_grid(40, 40);
  const PlateSystem system{grid, {1, 2, 1}, 0};
  const Field w = Field::Random(unknown_count(grid), 3);
  const Field f = -residual(system, w, Field::Zero(w.rows(), 3));
  CHECK((residual(system, w, f).array().abs() <= 1.2e-16 * f.array().abs() + 1e-12).all());
}

TEST_CASE("an assembly has as many entries as it says, at most", "[plate][operator]") {
  const Grid open = unit_grid(7, 6);
  const Grid ring{7, 6, 0.1, 0.2, true};
  const Edges free = {Edge::Free, Edge::Free, Edge::Pinned, Edge::Clamped};
  InteriorMask mask(static_cast<std::size_t>(open.node_count()), 0);
  for (const int node : {8, 9, 10, 15, 16, 22}) mask[static_cast<std::size_t>(node)] = 1;
  for (const Outline& outline :
       {Outline(open), Outline(open, free), Outline(open, mask), Outline(ring)}) {
    const GridAssembly assembly({outline, {1.5, -0.7, 2.25}, 0});
    const auto entries = assembly.entries().value();
    CHECK(entries.values.size() <= assembly.most_entries());
    CHECK(assembly.precise_entries().value().columns == entries.columns);
  }
}

TEST_CASE("the condition number is estimated within a factor", "[plate][operator]") {
  const Grid grid = GENERATE(unit_grid(9, 9), unit_grid(17, 6), Grid{9, 9, 0.5, 0.125});
  const double shift = GENERATE(0.0, 1e4);
  const PlateSystem system{grid, {1, 2, 1}, shift};
  const Eigen::VectorXd eigenvalues = eigenvalues_of(dense_operator(system));
  const double condition = eigenvalues.maxCoeff() / eigenvalues.minCoeff();
  // Clamping raises the smallest eigenvalue of the square from 4 pi^4 to 35.985^2: 3.3 times.
  CHECK(estimate_condition(system) >= 0.9 * condition);
  CHECK(estimate_condition(system) <= 12 * condition);
}
