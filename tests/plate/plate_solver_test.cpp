#include "pliant/plate/plate_solver.hpp"

#include "support/catch.hpp"
#include "support/plates.hpp"

using namespace pliant;
using pliant::testing::unit_grid;

TEST_CASE("choices of a solver have names", "[plate][solver]") {
  CHECK(solver_choice("auto") == SolverChoice::Auto);
  CHECK(solver_choice("spectral") == SolverChoice::Spectral);
  CHECK(solver_choice("supernodal") == SolverChoice::Supernodal);
  CHECK(solver_choice("cholmod") == SolverChoice::Cholmod);
  CHECK(solver_choice("eigen") == SolverChoice::Eigen);
  CHECK_FALSE(solver_choice("Auto"));
  for (const char* const name : {"auto", "spectral", "supernodal", "cholmod", "eigen"}) {
    CHECK(name_of(solver_choice(name).value()) == name);
  }
  CHECK(is_available(SolverChoice::Auto));
  CHECK(is_available(SolverChoice::Spectral));
  CHECK(available_solvers().front() == SolverChoice::Supernodal);
}

TEST_CASE("the automatic choice looks at the problem alone", "[plate][solver]") {
  const auto problem_on = [](const Grid& grid, double c) {
    return PlateProblem{grid, {1, c, 1}, {40, 20}, {}, Field::Ones(grid.node_count(), 3)};
  };
  const auto at_rest = [](const Grid& grid) {
    return PlateState{Field::Zero(grid.node_count(), 3), Field::Zero(grid.node_count(), 3)};
  };
  const auto automatic = make_plate_solver();
  long solves = 0;
  for (const int side : {60, 5, 61, 4, 60}) {  // from one solver to the other and back
    const Grid grid = unit_grid(side, side + 1);
    const PlateProblem problem = problem_on(grid, 2);
    const auto expected_solver =
        make_plate_solver(side > 50 ? SolverChoice::Spectral : available_solvers().front());
    const auto expected = expected_solver->advance(problem, {3, 0.01}, at_rest(grid)).value();
    const auto result = automatic->advance(problem, {3, 0.01}, at_rest(grid)).value();
    CHECK(result.displacement == expected.displacement);
    CHECK(result.velocity == expected.velocity);
    CHECK(automatic->counts().solves == (solves += 3));
    CHECK(automatic->memory() == expected_solver->memory());
  }
  // If the diagonal of the sines would lose digits, the matrix is factored.
  CHECK(worth_transforming(unit_grid(60, 60), {1, -1.9, 1}));
  CHECK_FALSE(worth_transforming(unit_grid(60, 60), {1, -1.99999, 1}));
  CHECK_FALSE(worth_transforming(unit_grid(300, 3), {1, 2, 1}));  // rows too short
}
