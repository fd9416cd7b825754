#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/LU>

#include "pliant/plate/plate_solver.hpp"
#include "support/catch.hpp"
#include "support/plates.hpp"

using namespace pliant;
using pliant::testing::dense_operator;
using pliant::testing::sampled;
using pliant::testing::unit_grid;
using pliant::testing::WithinAbs;
using pliant::testing::WithinRel;

namespace {

// Every test runs with every solver of this build.
std::vector<SolverChoice> choices() {
  std::vector<SolverChoice> all{SolverChoice::Spectral, SolverChoice::Eigen};
  if (is_available(SolverChoice::Cholmod)) all.push_back(SolverChoice::Cholmod);
  return all;
}
#define GENERATE_CHOICE() GENERATE(from_range(choices()))

PlateState at_rest(const Grid& grid) {
  return {Field::Zero(grid.node_count(), 3), Field::Zero(grid.node_count(), 3)};
}

Field solve_static(SolverChoice choice, const Grid& grid, const Stiffness& stiffness,
                   const EdgeTangents& tangents, const Field& load, PlateState state) {
  const auto solver = make_plate_solver(choice);
  const PlateProblem problem{grid, stiffness, {0, 0}, tangents, load};
  return solver->advance(problem, {1, 1}, std::move(state)).value().displacement;
}

// Observed order from errors at spacings h, h/2, h/4: the smaller of the two ratios.
double observed_order(const std::vector<double>& errors) {
  return std::min(std::log2(errors[0] / errors[1]), std::log2(errors[1] / errors[2]));
}

}  // namespace

TEST_CASE("a uniform load on the clamped square gives 0.00126532 q with order 2",
          "[plate][euler]") {
  const SolverChoice choice = GENERATE_CHOICE();
  const double q = 8000;
  std::vector<double> centres, errors;
  for (const int nodes : {17, 33, 65}) {
    const Grid grid = unit_grid(nodes, nodes);
    const Field w = solve_static(choice, grid, {1, 2, 1}, {},
                                 Field::Constant(grid.node_count(), 3, q), at_rest(grid));
    centres.push_back(w(grid.node(nodes / 2, nodes / 2), 1) / q);
    errors.push_back(std::abs(centres.back() - 0.00126532));
  }
  CHECK(observed_order(errors) >= 1.9);
  const double extrapolated = centres[2] + (centres[2] - centres[1]) / 3;
  CHECK_THAT(extrapolated, WithinAbs(0.00126532, 3e-8));  // the remaining error is O(h^4)
}

TEST_CASE("a manufactured solution with rim and tangents converges with order 2",
          "[plate][euler]") {
  const SolverChoice choice = GENERATE_CHOICE();
  // A tangent is one value for a whole edge, so the slope of w must be constant along each edge:
  // w = sin(2u + 1) + cos(3v), F = 16 b sin(2u + 1) + 81 d cos(3v).
  const Stiffness s{1.5, 0.5, 0.75};
  std::vector<double> errors;
  for (const int nodes : {17, 33, 65}) {
    const int rows = (nodes - 1) * 3 / 2 + 1;
    const Grid grid{nodes, rows, 1.0 / (nodes - 1), 0.8 / (rows - 1)};
    const auto exact = [](double u, double v) { return std::sin(2 * u + 1) + std::cos(3 * v); };
    const Field load = sampled(grid, [&](double u, double v) {
      return 16 * s.b * std::sin(2 * u + 1) + 81 * s.d * std::cos(3 * v);
    });
    EdgeTangents tangents;
    tangents.su0.setConstant(2 * std::cos(1.0));
    tangents.su1.setConstant(2 * std::cos(3.0));
    tangents.sv0.setConstant(0);
    tangents.sv1.setConstant(-3 * std::sin(3 * 0.8));
    const Field w_exact = sampled(grid, exact);
    PlateState state{with_interior(grid, w_exact, Field::Zero(unknown_count(grid), 3)),
                     Field::Zero(grid.node_count(), 3)};
    const Field w = solve_static(choice, grid, s, tangents, load, std::move(state));
    errors.push_back((w - w_exact).cwiseAbs().maxCoeff());
  }
  CHECK(observed_order(errors) >= 1.9);
}

TEST_CASE("an affine rim gives an affine plate", "[plate][euler]") {
  const SolverChoice choice = GENERATE_CHOICE();
  const Grid grid{8, 11, 0.5, 0.25};
  const Field affine = sampled(grid, [](double u, double v) { return 3 - 2 * u + 5 * v; });
  EdgeTangents tangents;
  tangents.su0.setConstant(-2);
  tangents.su1.setConstant(-2);
  tangents.sv0.setConstant(5);
  tangents.sv1.setConstant(5);
  PlateState state{with_interior(grid, affine, Field::Random(unknown_count(grid), 3)),
                   Field::Zero(grid.node_count(), 3)};
  const Field w =
      solve_static(choice, grid, {1, 2, 3}, tangents, Field::Zero(grid.node_count(), 3), state);
  CHECK((w - affine).cwiseAbs().maxCoeff() < 1e-11);  // condition 1e4 times values of 10
}

TEST_CASE("the 3 x 3 plate moves as by hand", "[plate][euler]") {
  const SolverChoice choice = GENERATE_CHOICE();
  const double h = 0.5, dt = 0.01;
  const Grid grid{3, 3, h, h};
  const Stiffness s{1, 2, 1};
  const double k = (8 * s.b + 4 * s.c + 8 * s.d) / (h * h * h * h);
  const Dynamics dynamics{40, 20};
  const double load = 700;
  const auto solver = make_plate_solver(choice);
  PlateState state = at_rest(grid);
  state.velocity(4, 2) = 0.25;
  double w = 0, v = 0.25;
  for (int frame = 0; frame < 5; ++frame) {
    const PlateProblem problem{grid, s, dynamics, {}, Field::Constant(9, 3, load)};
    state = solver->advance(problem, {3, dt}, std::move(state)).value();
    for (int step = 0; step < 3; ++step) {
      // rho (v' - v)/dt + eta v' + k w' = F with w' = w + dt v'.
      const double next_v = (load + dynamics.density / dt * v - k * w) /
                            (dynamics.density / dt + dynamics.damping + k * dt);
      w += dt * next_v;
      v = next_v;
    }
    CHECK_THAT(state.displacement(4, 2), WithinRel(w, 1e-13));
    CHECK_THAT(state.velocity(4, 2), WithinRel(v, 1e-12));
  }
  CHECK(solver->counts().factorizations == 1);
}

TEST_CASE("steps agree with a dense implicit step of the first-order system", "[plate][euler]") {
  const SolverChoice choice = GENERATE_CHOICE();
  const Grid grid = unit_grid(7, 6);
  const Stiffness s{1.5, 0.5, 2};
  const Dynamics dynamics{3, 7};
  const double dt = 1e-3;
  const int n = unknown_count(grid);
  const Eigen::MatrixXd L = dense_operator({grid, s, 0});
  // (w, v)' = (v, (F - L w - eta v)/rho): solved as one dense system of twice the size.
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(2 * n, 2 * n);
  A.topRightCorner(n, n).diagonal().setConstant(-dt);
  A.bottomLeftCorner(n, n) = dt / dynamics.density * L;
  A.bottomRightCorner(n, n).diagonal().array() += dt * dynamics.damping / dynamics.density;
  const Field load = Field::Random(grid.node_count(), 3);
  PlateState state = at_rest(grid);
  state.displacement = with_interior(grid, state.displacement, Field::Random(n, 3));
  state.velocity = with_interior(grid, state.velocity, Field::Random(n, 3));

  Eigen::MatrixXd x(2 * n, 3);
  x << interior_of(grid, state.displacement), interior_of(grid, state.velocity);
  const auto lu = A.partialPivLu();
  for (int step = 0; step < 20; ++step) {
    x.bottomRows(n) += dt / dynamics.density * interior_of(grid, load);
    x = lu.solve(x).eval();
  }
  const auto solver = make_plate_solver(choice);
  state = solver->advance({grid, s, dynamics, {}, load}, {20, dt}, state).value();
  CHECK((interior_of(grid, state.displacement) - x.topRows(n)).norm() <
        1e-11 * x.topRows(n).norm());
  CHECK((interior_of(grid, state.velocity) - x.bottomRows(n)).norm() <
        1e-9 * x.bottomRows(n).norm());
}

TEST_CASE("backward Euler has order 1 in dt, Newmark's steps order 2", "[plate][euler]") {
  const SolverChoice choice = GENERATE_CHOICE();
  const auto [integrator, order] =
      GENERATE(std::pair{Integrator::BackwardEuler, 1}, std::pair{Integrator::Newmark, 2});
  // One mode of the 3 x 3 plate is the damped oscillator rho w'' + eta w' + k w = 0.
  const Grid grid{3, 3, 1, 1};
  const double rho = 2, eta = 3, k = 24, end = 0.7;
  const double decay = eta / (2 * rho), omega = std::sqrt(k / rho - decay * decay);
  const double exact =
      std::exp(-decay * end) * (std::cos(omega * end) + decay / omega * std::sin(omega * end));
  std::vector<double> errors;
  for (const int count : {400, 800, 1600}) {
    PlateState state = at_rest(grid);
    state.displacement.row(4).setOnes();
    const auto solver = make_plate_solver(choice);
    const PlateProblem problem{grid, {1, 2, 1}, {rho, eta}, {}, Field::Zero(9, 3)};
    const TimeSteps steps{count, end / count, integrator};
    const PlateState last = solver->advance(problem, steps, state).value();
    errors.push_back(std::abs(last.displacement(4, 0) - exact));
  }
  CHECK_THAT(observed_order(errors), WithinAbs(order, 0.02));
}

TEST_CASE("loads add up", "[plate][euler]") {
  const SolverChoice choice = GENERATE_CHOICE();
  const Grid grid = unit_grid(9, 12);
  const Field f = Field::Random(grid.node_count(), 3), g = Field::Random(grid.node_count(), 3);
  const auto moved = [&](const Field& load) {
    const auto solver = make_plate_solver(choice);
    const PlateProblem problem{grid, {1, 2, 1}, {40, 20}, {}, load};
    return solver->advance(problem, {5, 0.01}, at_rest(grid)).value();
  };
  const PlateState a = moved(f), b = moved(g), both = moved(2 * f - 3 * g);
  const double scale = both.displacement.cwiseAbs().maxCoeff();
  CHECK((both.displacement - 2 * a.displacement + 3 * b.displacement).cwiseAbs().maxCoeff() <
        1e-13 * scale);
}

TEST_CASE("the three components do not know each other", "[plate][euler]") {
  const SolverChoice choice = GENERATE_CHOICE();
  const Grid grid = unit_grid(6, 7);
  Field load = Field::Zero(grid.node_count(), 3);
  load.col(1).setRandom();
  const auto solver = make_plate_solver(choice);
  const PlateProblem problem{grid, {1, 2, 1}, {40, 20}, {}, load};
  const PlateState state = solver->advance(problem, {5, 0.01}, at_rest(grid)).value();
  CHECK(state.displacement.col(0).isZero(0));
  CHECK(state.displacement.col(2).isZero(0));
  CHECK_FALSE(state.displacement.col(1).isZero(0));
}

TEST_CASE("the rim stays to the bit and carries no velocity", "[plate][euler]") {
  const SolverChoice choice = GENERATE_CHOICE();
  const Grid grid = unit_grid(6, 7);
  const PlateState before{Field::Random(grid.node_count(), 3), Field::Random(grid.node_count(), 3)};
  const auto solver = make_plate_solver(choice);
  const PlateProblem problem{grid, {1, 2, 1}, {40, 20}, {}, Field::Random(grid.node_count(), 3)};
  const PlateState after = solver->advance(problem, {5, 0.01}, before).value();
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) {
      if (i > 0 && i < grid.columns - 1 && j > 0 && j < grid.rows - 1) continue;
      CHECK(after.displacement.row(grid.node(i, j)) == before.displacement.row(grid.node(i, j)));
      CHECK(after.velocity.row(grid.node(i, j)).isZero(0));
    }
  }
}

TEST_CASE("without density and damping every step is the static solution", "[plate][euler]") {
  const SolverChoice choice = GENERATE_CHOICE();
  const Grid grid = unit_grid(8, 8);
  const PlateState before{Field::Random(grid.node_count(), 3), Field::Random(grid.node_count(), 3)};
  const auto solver = make_plate_solver(choice);
  const PlateProblem problem{grid, {1, 2, 1}, {0, 0}, {}, Field::Random(grid.node_count(), 3)};
  const PlateState once = solver->advance(problem, {1, 0.1}, before).value();
  const PlateState thrice = solver->advance(problem, {3, 0.1}, before).value();
  CHECK(once.displacement == thrice.displacement);
  CHECK(thrice.velocity.isZero(0));
  const Field expected_velocity =
      (interior_of(grid, once.displacement) - interior_of(grid, before.displacement)) / 0.1;
  CHECK((interior_of(grid, once.velocity) - expected_velocity).norm() <=
        1e-14 * expected_velocity.norm());
}

TEST_CASE("a solver's failure comes through", "[plate][euler]") {
  const SolverChoice choice = GENERATE_CHOICE();
  const Grid grid = unit_grid(9, 9);
  const auto solver = make_plate_solver(choice);
  const PlateProblem problem{grid, {1, -40, 1}, {0, 0}, {}, Field::Zero(81, 3)};
  const auto state = solver->advance(problem, {1, 1}, at_rest(grid));
  REQUIRE_FALSE(state);
  CHECK(state.error().code == ErrorCode::SolverFailed);
}
