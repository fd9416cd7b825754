#include "pliant/plate/spectral/spectral_plate.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "pliant/core/memory_budget.hpp"
#include "pliant/core/thread_pool.hpp"
#include "pliant/plate/plate_solver.hpp"
#include "support/catch.hpp"
#include "support/plates.hpp"
#include "support/sanitized.hpp"

using namespace pliant;
using pliant::testing::random_state;
using pliant::testing::residual;
using pliant::testing::unit_grid;

namespace {

// ||A||, or a little more: the largest eigenvalue of the simply supported plate plus the edges.
double operator_norm(const PlateSystem& system) {
  const Grid& grid = system.outline.grid();
  const Stiffness& stiffness = system.stiffness;
  const double shift = system.shift;
  const double u = 4 / (grid.hu * grid.hu);
  const double v = 4 / (grid.hv * grid.hv);
  return shift + 1.5 * (stiffness.b * u * u + stiffness.d * v * v) + std::abs(stiffness.c) * u * v;
}

// The diagonal loses digits as -c approaches 2 sqrt(bd): docs/model.md.
double loss(const Stiffness& stiffness) {
  return std::max(1.0, stiffness.least_c() / (stiffness.least_c() - stiffness.c));
}

double backward_error(const PlateSystem& system, const Field& w, const Field& f) {
  return residual(system, w, f).norm() / (operator_norm(system) * w.norm() + f.norm());
}

// b : c : d; in the last ones c is close to its bound.
constexpr Stiffness ratios[] = {{1, 2, 1},   {1, 0, 1},    {1, 20, 1},     {100, 2, 1},
                                {1, 2, 100}, {1, -1.9, 1}, {1, -1.999, 1}, {4, -11.9, 9}};
// A static plate, and steps from very long to very short.
constexpr double shifts[] = {0, 1e-3, 1e5, 1e14};

// Compares with a solution that is exact to the last digits: refined with residuals in extended
// precision. Returns the backward error.
double check_errors(const PlateSystem& system, const Field& f) {
  const auto solver = make_plate_solver(SolverChoice::Spectral);
  REQUIRE(solver->prepare(system));
  const Field w = solver->solve(f).value();
  Field exact = w;
  for (int pass = 0; pass < 3; ++pass) {
    exact += solver->solve(residual(system, exact, f)).value();
  }
  CHECK((w - exact).norm() <= 1e-14 * loss(system.stiffness) * exact.norm());
  const double error = backward_error(system, w, f);
  CHECK(error <= 4e-15 * loss(system.stiffness));
  return error;
}

void check_errors(const Grid& grid, const Stiffness& stiffness, double shift) {
  CAPTURE(grid.columns, grid.rows, stiffness.b, stiffness.c, stiffness.d, shift);
  check_errors({grid, stiffness, shift}, Field::Random(unknown_count(grid), 3));
}

// Compares with a factored matrix, by backward error.
void check_beside_direct(const PlateSystem& system) {
  const auto& [b, c, d] = system.stiffness;
  CAPTURE(system.outline.grid().columns, system.outline.grid().rows, b, c, d, system.shift);
  const Field f = Field::Random(unknown_count(system.outline), 3);
  const double error = check_errors(system, f);
  const auto direct = make_plate_solver(available_solvers().front());
  REQUIRE(direct->prepare(system));
  const double direct_error = backward_error(system, direct->solve(f).value(), f);
  CHECK(error <= 20 * loss(system.stiffness) * std::max(direct_error, 1.1e-16));
}

void check_exactness(const Grid& grid, const Stiffness& stiffness) {
  for (const double shift : shifts) check_beside_direct({grid, stiffness, shift});
}

PlateProblem problem_on(const Grid& grid, const Stiffness& stiffness, const Dynamics& dynamics) {
  EdgeTangents tangents;
  tangents.su0 = Vector3d(1, -2, 0.5);
  tangents.su1 = Vector3d(0, 1, 3);
  tangents.sv0 = Vector3d(-1, 0.25, 2);
  tangents.sv1 = Vector3d(2, 1, -1);
  return {grid, stiffness, dynamics, tangents, 100 * Field::Random(grid.node_count(), 3)};
}

}  // namespace

TEST_CASE("the spectral solver is as exact as a double allows on small plates",
          "[plate][spectral]") {
  const auto [columns, rows] =
      GENERATE(std::pair{3, 3}, std::pair{3, 4}, std::pair{4, 4}, std::pair{5, 3}, std::pair{9, 8},
               std::pair{17, 17}, std::pair{18, 18}, std::pair{20, 31});
  for (const Stiffness& stiffness : ratios) check_exactness(unit_grid(columns, rows), stiffness);
}

TEST_CASE("the spectral solver is as exact as a double allows on slivers", "[plate][spectral]") {
  const auto [columns, rows] =
      GENERATE(std::pair{3, 500}, std::pair{500, 3}, std::pair{4, 212}, std::pair{257, 5});
  for (const Stiffness& stiffness : ratios) check_exactness(unit_grid(columns, rows), stiffness);
}

// 101 and 37 intervals; 149 and 199 below are prime too.
TEST_CASE("the spectral solver is as exact as a double allows for prime lengths",
          "[plate][spectral]") {
  for (const Stiffness& stiffness : ratios) check_exactness(unit_grid(102, 38), stiffness);
}

TEST_CASE("the spectral solver is as exact as a double allows on squares", "[plate][spectral]") {
  if (testing::is_sanitized) return;  // other sizes run the same code
  for (const Stiffness& stiffness : {ratios[0], ratios[1], ratios[2], ratios[3]}) {
    check_exactness(unit_grid(101, 101), stiffness);
  }
}

TEST_CASE("the spectral solver is as exact as a double allows on squares, for other ratios",
          "[plate][spectral]") {
  if (testing::is_sanitized) return;  // other sizes run the same code
  for (const Stiffness& stiffness : {ratios[4], ratios[5], ratios[6], ratios[7]}) {
    check_exactness(unit_grid(101, 101), stiffness);
  }
}

// Factors of this size need a while: each ratio with one step, each step with two ratios.
TEST_CASE("the spectral solver is as exact as a double allows on 150 x 200 nodes",
          "[plate][spectral]") {
  if (testing::is_sanitized) return;  // its size is what it is about
  for (int k = 0; k < 8; ++k) check_beside_direct({unit_grid(150, 200), ratios[k], shifts[k % 4]});
}

TEST_CASE("the spectral solver stays exact on large plates", "[plate][spectral]") {
  if (testing::is_sanitized) return;  // their sizes are what it is about
  for (const Grid& grid : {unit_grid(402, 390), unit_grid(60, 801)}) {
    for (const double shift : shifts) check_errors(grid, {1, 2, 1}, shift);
  }
}

TEST_CASE("the spectral solver stays exact on 401 x 401 nodes", "[plate][spectral]") {
  if (testing::is_sanitized) return;
  for (const double shift : shifts) check_errors(unit_grid(401, 401), {1, 2, 1}, shift);
}

TEST_CASE("the spectral solver is as exact as a factor on 401 x 401 nodes", "[plate][spectral]") {
  if (testing::is_sanitized) return;  // its size is what it is about
  check_beside_direct({unit_grid(401, 401), {1, 2, 1}, shifts[1]});
}

// A static plate is the hardest case.
TEST_CASE("the spectral solver stays exact on 401 x 401 nodes at every ratio",
          "[plate][spectral]") {
  if (testing::is_sanitized) return;
  for (const Stiffness& stiffness : ratios) {
    check_errors(unit_grid(401, 401), stiffness, 0);
  }
}

TEST_CASE("steps in sine space are those of a factored matrix", "[plate][spectral]") {
  const Grid grid =
      GENERATE(unit_grid(3, 3), unit_grid(4, 3), unit_grid(3, 20), unit_grid(20, 3),
               unit_grid(14, 14), unit_grid(23, 12), unit_grid(12, 38), Grid{40, 41, 0.5, 0.125});
  const Stiffness stiffness =
      GENERATE(Stiffness{1, 2, 1}, Stiffness{3, -1, 0.5}, Stiffness{1, 0, 1}, Stiffness{1, 20, 1},
               Stiffness{100, 2, 1}, Stiffness{1, 2, 100}, Stiffness{1, -1.99, 1});
  if (testing::is_sanitized && stiffness.c != -1) return;
  for (const Dynamics dynamics :
       {Dynamics{40, 20}, Dynamics{0, 20}, Dynamics{40, 0}, Dynamics{0, 0}}) {
    for (const double dt : {1e-6, 1e-3, 1e3}) {
      if (testing::is_sanitized && dt != 1e-3) continue;
      const PlateProblem problem = problem_on(grid, stiffness, dynamics);
      const PlateState state = random_state(grid);
      const auto spectral = make_plate_solver(SolverChoice::Spectral);
      const auto direct = make_plate_solver(SolverChoice::Eigen);
      for (const TimeSteps& steps :
           {TimeSteps{1, dt}, TimeSteps{2, dt}, TimeSteps{13, dt},
            TimeSteps{1, dt, Integrator::Newmark}, TimeSteps{13, dt, Integrator::Newmark}}) {
        if (steps.are_reflected() && dynamics.density == 0) continue;
        CAPTURE(grid.columns, grid.rows, dynamics.density, dynamics.damping, dt, steps.count,
                steps.are_reflected());
        const PlateState a = spectral->advance(problem, steps, state).value();
        const PlateState b = direct->advance(problem, steps, state).value();
        // A velocity is a difference divided by dt, so it has the rounding errors of the
        // displacement divided by dt.
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
  const TimeSteps steps{7, 1e-3, GENERATE(Integrator::BackwardEuler, Integrator::Newmark)};
  const auto advance = [&](SpectralPlate& plate) {
    PlateState next = state;
    const double inertia = problem.dynamics.inertia(steps.solved_length());
    const double shift = problem.dynamics.shift(steps.solved_length());
    REQUIRE(plate.prepare({grid, problem.stiffness, shift}));
    const long first = grid.node(1, 1), count = grid.node_count();
    REQUIRE(plate.advance({problem.load.data() + first, grid.columns, count}, inertia, steps,
                          {next.displacement.data() + first, grid.columns, count},
                          {next.velocity.data() + first, grid.columns, count}));
    return next;
  };
  SpectralPlate plain;
  const PlateState expected = advance(plain);
  const auto check = [&](SpectralPlate& plate) {
    const PlateState next = advance(plate);
    CHECK(next.displacement == expected.displacement);
    CHECK(next.velocity == expected.velocity);
  };
  for (const int count : {2, 3, 8}) {
    ThreadPool threads(count);
    SpectralPlate plate({.threads = &threads});
    check(plate);
  }
  if (testing::watches_threads) return;
  for (int which = 0; runnable_kernels(which); ++which) {
    CAPTURE(runnable_kernels(which)->name);
    SpectralPlate plate({.most_lanes = runnable_kernels(which)->lanes});
    check(plate);
  }
  REQUIRE(plain.prepare({unit_grid(201, 33), {1, 2, 1}, 5}));  // larger, then back
  check(plain);
  REQUIRE(plain.prepare({unit_grid(rows, columns), {1, 2, 1}, 5}));
  check(plain);
}

TEST_CASE("a solution that is wanted at some nodes only has the bits of a whole one",
          "[plate][spectral][threads]") {
  const auto [columns, rows] =
      GENERATE(std::pair{60, 61}, std::pair{131, 97}, std::pair{41, 103}, std::pair{9, 11});
  const int count = GENERATE(1, 3, 40);
  const Grid grid = unit_grid(columns, rows);
  const int unknowns = unknown_count(grid);
  const long width = columns - 2;
  std::mt19937 random(static_cast<unsigned>(columns + count));
  std::vector<UnknownRun> runs;
  Field load = Field::Zero(unknowns, 3);
  for (int k = 0; k < count; ++k) {
    const int first = static_cast<int>(random() % static_cast<unsigned>(unknowns));
    // Some longer than a row.
    const int most = std::min(unknowns - first, static_cast<int>(random() % 3 == 0 ? 150 : 5));
    runs.push_back({first, 1 + static_cast<int>(random() % static_cast<unsigned>(most))});
    load.middleRows(first, runs.back().count) = Field::Random(runs.back().count, 3);
  }
  const auto solved = [&](const RunContext& context, const std::vector<UnknownRun>& where) {
    SpectralPlate plate(context);
    REQUIRE(plate.prepare({grid, {1.5, 1, 2}, 7}));
    Field solution = Field::Zero(unknowns, 3);
    const Field other = Field::Random(unknowns, 3);  // nothing of it may be left
    plate.solve_for({0, 2}, {other.data(), width, unknowns}, {},
                    {solution.data(), width, unknowns});
    plate.solve_for({0, 2}, {load.data(), width, unknowns}, where,
                    {solution.data(), width, unknowns});
    return solution;
  };
  const Field whole = solved({}, {});
  {
    SpectralPlate plate;
    REQUIRE(plate.prepare({grid, {1.5, 1, 2}, 7}));
    Field alone(unknowns, 3);
    plate.solve({load.data(), width, unknowns}, {alone.data(), width, unknowns});
    for (const int k : {0, 2})  // pairs of columns round otherwise
      CHECK((whole.col(k) - alone.col(k)).norm() <= 2e-14 * alone.col(k).norm());
  }
  const auto check = [&](const RunContext& context) {
    const Field some = solved(context, runs);
    for (const UnknownRun& run : runs) {
      CAPTURE(run.first, run.count);
      CHECK(some.middleRows(run.first, run.count) == whole.middleRows(run.first, run.count));
    }
  };
  ThreadPool threads(3);
  check({.threads = &threads});
  if (testing::watches_threads) return;
  for (int which = 0; runnable_kernels(which); ++which) {
    CAPTURE(runnable_kernels(which)->name);
    check({.most_lanes = runnable_kernels(which)->lanes});
  }
}

TEST_CASE("the spectral solver keeps within the memory it may have", "[plate][spectral]") {
  const Grid grid = unit_grid(101, 101);
  const PlateProblem problem{grid, {}, {}, {}, Field::Zero(grid.node_count(), 3)};
  const PlateState state = random_state(grid);
  MemoryBudget small(std::size_t{1} << 20);
  const auto refused = make_plate_solver(SolverChoice::Spectral, {.memory = &small})
                           ->advance(problem, {1, 1}, state);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::OutOfMemory);
  CHECK(small.available() == small.total());

  MemoryBudget enough(std::size_t{64} << 20);
  const auto solver = make_plate_solver(SolverChoice::Spectral, {.memory = &enough});
  REQUIRE(solver->advance(problem, {1, 1}, state));
  CHECK(enough.total() - enough.available() == solver->memory());
  CHECK(solver->memory() <= sizeof(double) * 40 * static_cast<std::size_t>(grid.node_count()));
  CHECK(solver->memory() >= sizeof(double) * 10 * static_cast<std::size_t>(grid.node_count()));
}

TEST_CASE("a plate in sine space stops when asked to", "[plate][spectral]") {
  const Grid grid = unit_grid(20, 20);
  const PlateProblem problem = problem_on(grid, {}, {});
  int asked = 0;
  const auto solver =
      make_plate_solver(SolverChoice::Spectral, {.should_stop = [&] { return ++asked == 4; }});
  const auto stopped = solver->advance(problem, {10, 0.1}, random_state(grid));
  REQUIRE_FALSE(stopped);
  CHECK(stopped.error().code == ErrorCode::Interrupted);
  CHECK(asked == 4);
}
