#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Cholesky>

#include "pliant/core/memory_budget.hpp"
#include "pliant/core/profile.hpp"
#include "pliant/plate/plate_solver.hpp"
#include "support/catch.hpp"
#include "support/plates.hpp"

using namespace pliant;
using pliant::testing::dense_operator;
using pliant::testing::residual;
using pliant::testing::unit_grid;

// Every test runs with every solver of this build: they share errors and tolerance.
#define GENERATE_SOLVER() GENERATE(from_range(available_solvers()))

TEST_CASE("solvers agree with dense Cholesky", "[plate][solver]") {
  const auto solver = make_plate_solver(GENERATE_SOLVER());
  const Grid grid = GENERATE(unit_grid(3, 3), unit_grid(3, 9), unit_grid(12, 4), unit_grid(13, 11));
  const Stiffness stiffness = GENERATE(Stiffness{1, 2, 1}, Stiffness{1, 0, 1}, Stiffness{1, 20, 1},
                                       Stiffness{100, 2, 1}, Stiffness{1, -1.99, 1});
  for (const double shift : {0.0, 1e5, 1e12}) {
    const PlateSystem system{grid, stiffness, shift};
    const Field f = Field::Random(unknown_count(grid), 3);
    REQUIRE(solver->prepare(system));
    const Field w = solver->solve(f).value();
    const Eigen::MatrixXd dense = dense_operator(system);
    const Field expected = dense.llt().solve(f);
    // Both are backward stable: the forward error is the condition number times a few eps. In sine
    // space the diagonal is close to 0 if c is close to its bound, which the edges do not
    // compensate.
    const double near_bound = stiffness.c < 0 ? 2 / (2 + stiffness.c) : 1;
    const double condition = near_bound * dense.norm() * dense.inverse().norm();
    CHECK((w - expected).norm() <= 50 * condition * 1.1e-16 * expected.norm());
    // The residual is small for any condition.
    CHECK((dense * w - f).norm() <= 1e-14 * near_bound * (dense.norm() * w.norm() + f.norm()));
  }
}

TEST_CASE("solvers keep what they can", "[plate][solver]") {
  const auto solver = make_plate_solver(GENERATE_SOLVER());
  const auto counts = [&] {
    const SolverCounts c = solver->counts();
    return std::array{c.analyses, c.factorizations, c.solves};
  };
  const Field f = Field::Random(35, 3);
  PlateSystem system{unit_grid(9, 7), {1, 2, 1}, 5};
  REQUIRE(solver->prepare(system));
  CHECK(counts() == std::array{1l, 1l, 0l});
  const Field w = solver->solve(f).value();
  REQUIRE(solver->prepare(system));
  CHECK(solver->solve(f).value() == w);
  CHECK(counts() == std::array{1l, 1l, 2l});

  system.stiffness.c = 1;  // other coefficients: the same pattern
  REQUIRE(solver->prepare(system));
  CHECK(counts() == std::array{1l, 2l, 2l});
  system.outline = unit_grid(7, 9);  // as many unknowns, another pattern
  REQUIRE(solver->prepare(system));
  CHECK(counts() == std::array{2l, 3l, 2l});

  // A return to the first system gives the same bits as the first time.
  REQUIRE(solver->prepare({unit_grid(9, 7), {1, 2, 1}, 5}));
  CHECK(solver->solve(f).value() == w);
}

TEST_CASE("solvers refuse a matrix that is not positive definite", "[plate][solver]") {
  const auto solver = make_plate_solver(GENERATE_SOLVER());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const PlateSystem bad = GENERATE_COPY(
      PlateSystem{unit_grid(9, 9), {1, -40, 1}, 0}, PlateSystem{unit_grid(9, 9), {1, 2, 1}, -1e7},
      PlateSystem{unit_grid(9, 9), {1, 2, 1}, nan}, PlateSystem{unit_grid(3, 3), {0, 0, 0}, 0});
  const auto factored = solver->prepare(bad);
  REQUIRE_FALSE(factored);
  CHECK(factored.error().code == ErrorCode::SolverFailed);
  CHECK_THAT(factored.error().message,
             Catch::Matchers::Contains(std::to_string(unknown_count(bad.outline)) + " unknowns") &&
                 Catch::Matchers::Contains("pivot"));
  // After a failure the solver works for the next system.
  const PlateSystem good{bad.outline, {1, 2, 1}, 1};
  REQUIRE(solver->prepare(good));
  const Field f = Field::Ones(unknown_count(good.outline), 3);
  CHECK(solver->solve(f).value().allFinite());
}

TEST_CASE("ill-conditioned plates are solved to the last digits", "[plate][solver]") {
  // Static: the condition number is about 3e7 for the square and far beyond for the sliver, so a
  // plain factorisation loses 8 digits and more. The reference is refined until it does not change.
  const auto solver = make_plate_solver(GENERATE_SOLVER());
  const Grid grid = GENERATE(unit_grid(121, 121), unit_grid(5, 400));
  const PlateSystem system{grid, {1, 2, 1}, 0};
  REQUIRE(estimate_condition(system) > 1e7);
  REQUIRE(solver->prepare(system));
  const Field f = Field::Random(unknown_count(grid), 3);
  const Field w = solver->solve(f).value();
  Field yardstick = w;
  for (int pass = 0; pass < 5; ++pass) {
    yardstick += solver->solve(residual(system, yardstick, f)).value();
  }
  CHECK((w - yardstick).norm() < 1e-14 * yardstick.norm());
}

TEST_CASE("solvers keep to the context that they were made with", "[plate][solver]") {
  const SolverChoice choice = GENERATE_SOLVER();
  MemoryBudget memory(std::size_t{64} << 20);
  Profile profile;
  int asked = 0, patience = 1000;
  const RunContext context{
      .memory = &memory, .profile = &profile, .should_stop = [&] { return ++asked > patience; }};
  const Grid grid = unit_grid(30, 31);
  const Field zero = Field::Zero(grid.node_count(), 3);
  const PlateProblem problem{grid, {1, 2, 1}, {40, 20}, {}, Field::Ones(grid.node_count(), 3)};
  {
    const auto solver = make_plate_solver(choice, context);
    REQUIRE(solver->advance(problem, {5, 0.01}, {zero, zero}));
    CHECK(asked >= 5);  // for each step, and while a matrix is factored
    CHECK(memory.total() - memory.available() == solver->memory());
    CHECK(profile[Stage::SetUp] > 0);
    CHECK(profile[Stage::Solve] > 0);
    CHECK(profile.total() == profile[Stage::SetUp] + profile[Stage::Solve]);
    const int before = asked;
    patience = before + 2;
    const auto stopped = solver->advance(problem, {5, 0.01}, {zero, zero});
    REQUIRE_FALSE(stopped);
    CHECK(stopped.error().code == ErrorCode::Interrupted);
    CHECK(asked == before + 3);
  }
  CHECK(memory.available() == memory.total());
}

TEST_CASE("what is stopped while it is prepared or solved has the same bits when it is done again",
          "[plate][solver]") {
  const SolverChoice choice =
      GENERATE(filter(&is_available, values({SolverChoice::Supernodal, SolverChoice::Cholmod})));
  int asked = 0, patience = 10'000;
  const RunContext context{.should_stop = [&] { return ++asked > patience; }};
  const PlateSystem system{unit_grid(130, 131), {1, 2, 1}, 0};
  const Field f = Field::Random(unknown_count(system.outline), 3);
  const auto undisturbed = make_plate_solver(choice, context);
  REQUIRE(undisturbed->prepare(system));
  const int times = asked;
  const Field expected = undisturbed->solve(f).value();
  const int all = asked;
  CHECK(times > 10);
  CHECK(all > times);  // the first solve measures its error
  std::vector<int> stops = {1, times / 2};
  for (int stop_at = times; stop_at <= all; ++stop_at) stops.push_back(stop_at);
  for (const int stop_at : stops) {
    CAPTURE(stop_at, times, all);
    const auto solver = make_plate_solver(choice, context);
    asked = 0;
    patience = stop_at - 1;
    auto stopped = solver->prepare(system);
    CHECK(stopped.has_value() == (stop_at > times));
    if (stopped) {
      const auto solved = solver->solve(f);
      REQUIRE_FALSE(solved);
      stopped = fail(solved.error());
    }
    CHECK(stopped.error().code == ErrorCode::Interrupted);
    CHECK(asked == stop_at);
    patience = 10'000;
    REQUIRE(solver->prepare(system));
    CHECK(solver->solve(f).value() == expected);
  }
}

TEST_CASE("the solver of the factors comes first", "[plate][solver]") {
  CHECK(available_solvers().front() != SolverChoice::Spectral);
  CHECK(available_solvers().back() == SolverChoice::Spectral);
}
