#include "pliant/plate/vibration.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>

#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

double smallest(const Grid& grid, const Stiffness& stiffness,
                SolverKind kind = available_solvers().front()) {
  const auto solver = make_solver(kind);
  return smallest_eigenvalue(*solver, grid, stiffness).value();
}

// The slow way: all eigenvalues of the full matrix.
double smallest_of_all(const Grid& grid, const Stiffness& stiffness) {
  const Eigen::MatrixXd matrix = assemble_upper({grid, stiffness, 0});
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix.selfadjointView<Eigen::Upper>(),
                                                        Eigen::EigenvaluesOnly)
      .eigenvalues()(0);
}

}  // namespace

TEST_CASE("the smallest eigenvalue is that of the full matrix", "[plate][vibration]") {
  for (const Grid& grid :
       {Grid{3, 3, 1, 1}, Grid{3, 4, 0.5, 1}, Grid{4, 4, 1, 1}, Grid{5, 9, 0.1, 0.3},
        Grid{3, 40, 1, 1}, Grid{25, 9, 1e-3, 1e-3}, Grid{8, 17, 1e3, 1e3}}) {
    for (const Stiffness& stiffness :
         {Stiffness{1, 2, 1}, Stiffness{1, 0, 1}, Stiffness{100, 2, 1}, Stiffness{1, -1.99, 1}}) {
      CAPTURE(grid.columns, grid.rows, stiffness.b, stiffness.c);
      CHECK_THAT(smallest(grid, stiffness), WithinRel(smallest_of_all(grid, stiffness), 1e-4));
    }
  }
}

TEST_CASE("the clamped square vibrates at 35.985, with an error of second order",
          "[plate][vibration]") {
  // SPEC 11: omega of the unit square with rho = 1 is the root of the eigenvalue.
  const SolverKind kind = GENERATE(from_range(available_solvers()));
  const auto error = [&](int count) {
    const double h = 1.0 / (count - 1);
    return std::abs(std::sqrt(smallest({count, count, h, h}, {}, kind)) - 35.985);
  };
  const double coarse = error(17), fine = error(33), finest = error(65);
  CHECK(std::log2(coarse / fine) > 1.9);
  CHECK(std::log2(fine / finest) > 1.9);
  CHECK(finest < 0.1);
}

TEST_CASE("a sliver's close eigenvalues do not stop the search", "[plate][vibration]") {
  // Far from its short ends a long strip is a beam between clamped edges: 22.373^2 / width^4.
  const double h = 1.0 / 24;
  const double strip = smallest({25, 601, h, h}, {});
  CHECK(strip > 0.97 * 22.373 * 22.373);
  CHECK(strip < 1.03 * 22.373 * 22.373);
}
