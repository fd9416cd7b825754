#include "pliant/plate/spectral_plate.hpp"

#include <cmath>
#include <vector>

#include "pliant/plate/plate_solver.hpp"
#include "support/catch.hpp"
#include "support/plates.hpp"

using namespace pliant;
using pliant::testing::unit_grid;

namespace {

// ||A||, or a little more: the largest eigenvalue of the simply supported plate and the edges.
double operator_norm(const PlateSystem& system) {
  const Grid& grid = system.grid;
  const Stiffness& stiffness = system.stiffness;
  const double shift = system.shift;
  const double u = 4 / (grid.hu * grid.hu);
  const double v = 4 / (grid.hv * grid.hv);
  return shift + 1.5 * (stiffness.b * u * u + stiffness.d * v * v) + std::abs(stiffness.c) * u * v;
}

// What 2 sqrt(bd) is above -c, the diagonal loses where the edges give: docs/model.md.
double loss(const Stiffness& stiffness) {
  return std::max(1.0, stiffness.least_c() / (stiffness.least_c() - stiffness.c));
}

struct Solved {
  Field solution;
  double backward_error;
};

Solved solved(SolverKind kind, const PlateSystem& system, const Field& f) {
  const auto solver = make_solver(kind);
  REQUIRE(solver->factor(system));
  Field w = solver->solve(f).value();
  const double error =
      residual(system, w, f).norm() / (operator_norm(system) * w.norm() + f.norm());
  return {std::move(w), error};
}

// A solution right to the last digits: refined with residuals in extended precision.
Field refined(const PlateSystem& system, const Field& f) {
  const auto solver = make_solver(SolverKind::Spectral);
  REQUIRE(solver->factor(system));
  Field w = solver->solve(f).value();
  for (int pass = 0; pass < 4; ++pass) w += solver->solve(residual(system, w, f)).value();
  return w;
}

PlateProblem problem_on(const Grid& grid, const Stiffness& stiffness, const Dynamics& dynamics) {
  EdgeTangents tangents;
  tangents.su0 = Vector3d(1, -2, 0.5);
  tangents.su1 = Vector3d(0, 1, 3);
  tangents.sv0 = Vector3d(-1, 0.25, 2);
  tangents.sv1 = Vector3d(2, 1, -1);
  return {grid, stiffness, dynamics, tangents, 100 * Field::Random(grid.node_count(), 3)};
}

PlateState random_state(const Grid& grid) {
  return {Field::Random(grid.node_count(), 3), Field::Random(grid.node_count(), 3)};
}

}  // namespace

TEST_CASE("the spectral solver is as exact as a double allows", "[plate][spectral]") {
  const auto [columns, rows] =
      GENERATE(std::pair{3, 3}, std::pair{3, 4}, std::pair{4, 4}, std::pair{5, 3}, std::pair{9, 8},
               std::pair{17, 17}, std::pair{20, 31}, std::pair{3, 500}, std::pair{500, 3},
               std::pair{102, 38}, std::pair{101, 101}, std::pair{150, 200});
  const Stiffness stiffness = GENERATE(
      Stiffness{1, 2, 1}, Stiffness{1, 0, 1}, Stiffness{1, 20, 1}, Stiffness{100, 2, 1},
      Stiffness{1, 2, 100}, Stiffness{1, -1.9, 1}, Stiffness{1, -1.999, 1}, Stiffness{4, -11.9, 9});
  const Grid grid = unit_grid(columns, rows);
  for (const double shift : {0.0, 1e-3, 1e5, 1e14}) {
    CAPTURE(columns, rows, stiffness.b, stiffness.c, stiffness.d, shift);
    const PlateSystem system{grid, stiffness, shift};
    const Field f = Field::Random(unknown_count(grid), 3);
    const Solved spectral = solved(SolverKind::Spectral, system, f);
    const Field exact = refined(system, f);
    CHECK((spectral.solution - exact).norm() <= 1e-14 * loss(stiffness) * exact.norm());
    CHECK(spectral.backward_error <= 4e-15 * loss(stiffness));
    const Solved direct = solved(available_solvers().front(), system, f);
    CHECK(spectral.backward_error <=
          20 * loss(stiffness) * std::max(direct.backward_error, 1.1e-16));
  }
}

TEST_CASE("the spectral solver stays exact on large plates", "[plate][spectral]") {
  const Grid grid = GENERATE(unit_grid(401, 401), unit_grid(402, 390), unit_grid(60, 801));
  const PlateSystem system{grid, {1, 2, 1}, 0};
  const Field f = Field::Random(unknown_count(grid), 3);
  const Field exact = refined(system, f);
  const Solved spectral = solved(SolverKind::Spectral, system, f);
  CHECK((spectral.solution - exact).norm() <= 1e-14 * exact.norm());
}

TEST_CASE("steps in sine space are those of a factored matrix", "[plate][spectral]") {
  const Grid grid =
      GENERATE(unit_grid(3, 3), unit_grid(4, 3), unit_grid(3, 20), unit_grid(20, 3),
               unit_grid(14, 14), unit_grid(23, 12), unit_grid(12, 38), Grid{40, 41, 0.5, 0.125});
  const Stiffness stiffness = GENERATE(Stiffness{1, 2, 1}, Stiffness{3, -1, 0.5});
  for (const Dynamics dynamics : {Dynamics{40, 20}, Dynamics{0, 20}, Dynamics{40, 0}}) {
    for (const double dt : {1e-6, 1e-3, 1e3}) {
      const PlateProblem problem = problem_on(grid, stiffness, dynamics);
      const PlateState state = random_state(grid);
      const auto spectral = make_plate_solver(SolverChoice::Spectral);
      const auto direct = make_plate_solver(SolverChoice::Eigen);
      for (const int count : {1, 2, 13}) {
        CAPTURE(grid.columns, grid.rows, dynamics.density, dynamics.damping, dt, count);
        const PlateState a = spectral->advance(problem, {count, dt}, state).value();
        const PlateState b = direct->advance(problem, {count, dt}, state).value();
        // A velocity is a difference over dt: the roundings of the displacement, over dt.
        const double scale = b.displacement.norm();
        CHECK((a.displacement - b.displacement).norm() <= 1e-11 * scale);
        CHECK((a.velocity - b.velocity).norm() <= 1e-11 * (b.velocity.norm() + scale / dt));
      }
    }
  }
}

TEST_CASE("no bit depends on threads, on the width of vectors or on what was kept",
          "[plate][spectral][threads]") {
  const auto [columns, rows] =
      GENERATE(std::pair{60, 61}, std::pair{131, 97}, std::pair{40, 302}, std::pair{64, 200});
  const Grid grid = unit_grid(columns, rows);
  const PlateProblem problem = problem_on(grid, {1.5, 1, 2}, {40, 20});
  const PlateState state = random_state(grid);
  const double dt = 1e-3;
  const auto advance = [&](SpectralPlate& plate) {
    PlateState next = state;
    const Dynamics& dynamics = problem.dynamics;
    const double inertia = dynamics.density / dt;
    REQUIRE(plate.prepare({grid, problem.stiffness, (inertia + dynamics.damping) / dt}));
    const long first = grid.node(1, 1), count = grid.node_count();
    REQUIRE(plate.advance({problem.load.data() + first, grid.columns, count}, inertia, {7, dt},
                          {next.displacement.data() + first, grid.columns, count},
                          {next.velocity.data() + first, grid.columns, count}, {}));
    return next;
  };
  SpectralPlate plain(nullptr);
  const PlateState expected = advance(plain);
  const auto check = [&](SpectralPlate& plate) {
    const PlateState next = advance(plate);
    CHECK(next.displacement == expected.displacement);
    CHECK(next.velocity == expected.velocity);
  };
  for (const int count : {2, 3, 8}) {
    ThreadPool threads(count);
    SpectralPlate plate(nullptr, &threads);
    check(plate);
  }
  for (int which = 0; runnable_kernels(which); ++which) {
    CAPTURE(runnable_kernels(which)->name);
    SpectralPlate plate(nullptr, nullptr, *runnable_kernels(which));
    check(plate);
  }
  REQUIRE(plain.prepare({unit_grid(201, 33), {1, 2, 1}, 5}));  // larger, then back
  check(plain);
  REQUIRE(plain.prepare({unit_grid(rows, columns), {1, 2, 1}, 5}));
  check(plain);
}

TEST_CASE("the spectral solver keeps within the memory it may have", "[plate][spectral]") {
  const Grid grid = unit_grid(101, 101);
  const PlateProblem problem{grid, {}, {}, {}, Field::Zero(grid.node_count(), 3)};
  const PlateState state = random_state(grid);
  MemoryBudget small(std::size_t{1} << 20);
  const auto refused =
      make_plate_solver(SolverChoice::Spectral, &small)->advance(problem, {1, 1}, state);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::OutOfMemory);
  CHECK(small.available() == small.total());

  MemoryBudget enough(std::size_t{64} << 20);
  const auto solver = make_plate_solver(SolverChoice::Spectral, &enough);
  REQUIRE(solver->advance(problem, {1, 1}, state));
  CHECK(enough.total() - enough.available() == solver->memory());
  CHECK(solver->memory() <= sizeof(double) * 40 * static_cast<std::size_t>(grid.node_count()));
  CHECK(solver->memory() >= sizeof(double) * 10 * static_cast<std::size_t>(grid.node_count()));
}

TEST_CASE("a plate in sine space stops when asked to", "[plate][spectral]") {
  const Grid grid = unit_grid(20, 20);
  const PlateProblem problem = problem_on(grid, {}, {});
  int asked = 0;
  const auto solver = make_plate_solver(SolverChoice::Spectral);
  const auto stopped =
      solver->advance(problem, {10, 0.1}, random_state(grid), [&] { return ++asked == 4; });
  REQUIRE_FALSE(stopped);
  CHECK(stopped.error().code == ErrorCode::Interrupted);
  CHECK(asked == 4);
}
