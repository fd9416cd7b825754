#include "pliant/plate/vibration.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "pliant/plate/small_modes.hpp"
#include "support/catch.hpp"
#include "support/dense.hpp"
#include "support/plates.hpp"
#include "support/sanitized.hpp"

using namespace pliant;
using pliant::testing::assemble_upper;
using namespace pliant::testing;

namespace {

double smallest(const Grid& grid, const Stiffness& stiffness,
                SolverChoice kind = available_solvers().front()) {
  const auto solver = make_plate_solver(kind);
  return smallest_eigenvalue(vibrating(*solver, {grid, stiffness, 0}).value()).value();
}

// An independent slow path: all eigenvalues of the full matrix.
double smallest_of_all(const Grid& grid, const Stiffness& stiffness) {
  const Eigen::MatrixXd matrix = assemble_upper({grid, stiffness, 0});
  return eigenvalues_of(matrix.selfadjointView<Eigen::Upper>())(0);
}

}  // namespace

TEST_CASE("the smallest eigenvalue is that of the full matrix", "[plate][vibration]") {
  for (const Grid& grid :
       {Grid{3, 3, 1, 1}, Grid{3, 4, 0.5, 1}, Grid{4, 4, 1, 1}, Grid{5, 9, 0.1, 0.3},
        Grid{3, 40, 1, 1}, Grid{25, 9, 1e-3, 1e-3}, Grid{8, 17, 1e3, 1e3}}) {
    for (const Stiffness& stiffness :
         {Stiffness{1, 2, 1}, Stiffness{1, 0, 1}, Stiffness{100, 2, 1}, Stiffness{1, -1.99, 1}}) {
      CAPTURE(grid.columns, grid.rows, stiffness.b, stiffness.c);
      CHECK_THAT(smallest(grid, stiffness), WithinRel(smallest_of_all(grid, stiffness), 1e-9));
    }
  }
}

TEST_CASE("the clamped square vibrates at 35.985, with an error of second order",
          "[plate][vibration]") {
  // SPEC 11: omega of the unit square with rho = 1 is the root of the eigenvalue.
  const SolverChoice kind = GENERATE(from_range(available_solvers()));
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

TEST_CASE("a plate of another outline vibrates as its full matrix says", "[plate][vibration]") {
  // An L: the square without its upper right quarter.
  const Grid grid{13, 13, 1.0 / 12, 1.0 / 12};
  InteriorMask interior(static_cast<std::size_t>(grid.node_count()), 0);
  for (int j = 1; j < 12; ++j) {
    for (int i = 1; i < 12; ++i) {
      if (i < 6 || j < 6) interior[static_cast<std::size_t>(grid.node(i, j))] = 1;
    }
  }
  const PlateSystem system{{grid, interior}, {1, 2, 3}, 0};
  const Eigen::MatrixXd matrix = assemble_upper(system);
  const double expected = eigenvalues_of(matrix.selfadjointView<Eigen::Upper>())(0);
  const auto solver = make_plate_solver(available_solvers().front());
  CHECK_THAT(smallest_eigenvalue(vibrating(*solver, system).value()).value(),
             WithinRel(expected, 1e-10));
}

TEST_CASE("slivers vibrate as their full matrices say", "[plate][vibration]") {
  if (is_sanitized) return;  // their sizes are what it is about
  // Hundreds of vibrations are within a few percent of the slowest one.
  for (const Grid& grid : {Grid{5, 200, 1, 1}, Grid{120, 6, 0.01, 0.02}, Grid{9, 70, 1, 3}}) {
    for (const Stiffness& stiffness : {Stiffness{1, 2, 1}, Stiffness{1, -1.9, 1}}) {
      CAPTURE(grid.columns, grid.rows, stiffness.c);
      CHECK_THAT(smallest(grid, stiffness), WithinRel(smallest_of_all(grid, stiffness), 1e-8));
    }
  }
}

TEST_CASE("the small modes are those of Eigen", "[plate][vibration]") {
  for (const int size : {1, 2, 3, 7, 18}) {
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Random(size, size);
    matrix += matrix.transpose().eval();
    const SmallModes modes =
        small_modes({matrix.data(), matrix.data() + matrix.size()}, static_cast<std::size_t>(size));
    const Eigen::VectorXd all = eigenvalues_of(matrix);
    for (int k = 0; k < size; ++k) {
      CAPTURE(size, k);
      CHECK_THAT(modes.values[static_cast<std::size_t>(k)], WithinAbs(all(k), 1e-13 * size));
      const Eigen::Map<const Eigen::VectorXd> vector(&modes.vectors[std::size_t(k) * size], size);
      CHECK((matrix * vector - all(k) * vector).norm() < 1e-12 * size);
    }
  }
  // Of equal values, and of sizes far apart.
  const SmallModes equal = small_modes({2, 0, 0, 0, 2, 0, 0, 0, 1e-200}, 3);
  CHECK(equal.values == std::vector<double>{1e-200, 2, 2});
}

TEST_CASE("a shape falls apart into the vibrations of the full matrix", "[plate][vibration]") {
  const SolverChoice kind = GENERATE(from_range(available_solvers()));
  const auto solver = make_plate_solver(kind);
  for (const Grid& grid : {Grid{15, 12, 0.07, 0.1}, Grid{4, 3, 1, 1}, Grid{3, 3, 1, 1}}) {
    const PlateSystem system{grid, {1, 2, 2}, 0};
    const Eigen::MatrixXd matrix = assemble_upper(system);
    const Modes all = modes_of(matrix.selfadjointView<Eigen::Upper>());
    // The displacement under a load on a few nodes, off the middle.
    const Eigen::Index size = unknown_count(system.outline);
    Eigen::VectorXd load = Eigen::VectorXd::Zero(size);
    load(size / 3) = 2;
    load(size / 2) = 1;
    const Eigen::VectorXd shape =
        matrix.selfadjointView<Eigen::Upper>().toDenseMatrix().ldlt().solve(load);
    const Eigen::Index node = size / 3;
    const auto modes = excited_modes(vibrating(*solver, system).value(), shape, node).value();
    double shares = 0;
    for (const ExcitedMode& mode : modes) shares += mode.share;
    CHECK_THAT(shares, WithinRel(1.0, 1e-9));
    CHECK(std::is_sorted(modes.begin(), modes.end(),
                         [](const auto& a, const auto& b) { return a.lambda < b.lambda; }));
    // The slowest modes, individually.
    const std::size_t compared = std::min<std::size_t>(modes.size(), size == 130 ? 4 : 1);
    for (std::size_t k = 0; k < compared; ++k) {
      const auto vector = all.vectors.col(static_cast<Eigen::Index>(k));
      CAPTURE(grid.columns, k);
      CHECK_THAT(modes[k].lambda, WithinRel(all.values(static_cast<Eigen::Index>(k)), 1e-6));
      CHECK_THAT(modes[k].share, WithinAbs(vector.dot(shape) * vector(node) / shape(node), 1e-6));
    }
  }
}

TEST_CASE("what is odd in the middle has no part in the slowest vibration", "[plate][vibration]") {
  const Grid grid{21, 21, 0.05, 0.05};
  Eigen::VectorXd shape(unknown_count(grid));
  for (Eigen::Index k = 0; k < shape.size(); ++k) {
    const double x = static_cast<double>(k % 19 + 1) / 20, y = static_cast<double>(k / 19 + 1) / 20;
    shape(k) = x * (1 - x) * y * (1 - y) * (x - 0.5);
  }
  const auto solver = make_plate_solver(available_solvers().front());
  const PlateSystem system{grid, {}, 0};
  const auto modes = excited_modes(vibrating(*solver, system).value(), shape, 3).value();
  const double first = smallest_eigenvalue(vibrating(*solver, system).value()).value();
  for (const ExcitedMode& mode : modes) {
    if (mode.lambda < 2 * first) CHECK(std::abs(mode.share) < 1e-9);  // rounding error
  }
  CHECK(modes.size() > 2);
}

TEST_CASE("vibrations are no longer searched when the run is stopped", "[plate][vibration]") {
  int asked = 0, patience = 0;
  const auto solver =
      make_plate_solver(SolverChoice::Auto, {.should_stop = [&] { return asked++ == patience; }});
  const PlateSystem system{Grid{12, 13, 1.0 / 11, 1.0 / 12}, {1, 2, 1}, 0};
  const Eigen::VectorXd shape = Eigen::VectorXd::LinSpaced(unknown_count(system.outline), 1, 2);
  for (patience = 0; patience < 3; ++patience) {
    asked = 0;
    const auto lambda = smallest_eigenvalue(vibrating(*solver, system).value());
    REQUIRE_FALSE(lambda);
    CHECK(lambda.error().code == ErrorCode::Interrupted);
    CHECK(asked == patience + 1);
    asked = 0;
    const auto modes = excited_modes(vibrating(*solver, system).value(), shape, 3);
    REQUIRE_FALSE(modes);
    CHECK(modes.error().code == ErrorCode::Interrupted);
    CHECK(asked == patience + 1);
  }
}
