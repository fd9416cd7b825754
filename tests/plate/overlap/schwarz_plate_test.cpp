#include "pliant/plate/overlap/schwarz_plate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/core/memory_budget.hpp"
#include "pliant/core/thread_pool.hpp"
#include "pliant/plate/advance.hpp"
#include "pliant/plate/plate_solver.hpp"
#include "pliant/plate/solver_factories.hpp"
#include "support/catch.hpp"
#include "support/plates.hpp"
#include "support/sanitized.hpp"
#include "support/unions.hpp"

using namespace pliant;
using pliant::testing::ell;
using pliant::testing::random_state;
using pliant::testing::union_plate;
using pliant::testing::union_plates;
using pliant::testing::UnionPlate;

namespace {

NodesView view(const UnionPlate& plate, Field& field) {
  return {field.data(), plate.grid.columns, plate.grid.node_count()};
}
ConstNodesView load_view(const UnionPlate& plate, const Field& field) {
  return {field.data(), plate.grid.columns, plate.grid.node_count()};
}

Result<void> prepare(SchwarzPlate& schwarz, const PlateSystem& system) {
  return schwarz.prepare(system.outline, system.stiffness, system.shift);
}

// The solution for a load on all nodes, from a guess of 0.
Field solved(SchwarzPlate& schwarz, const UnionPlate& plate, const Field& load) {
  Field solution = Field::Zero(plate.grid.node_count(), 3);
  REQUIRE(schwarz.solve(load_view(plate, load), view(plate, solution)));
  return interior_of(plate.outline(), solution);
}

// By a factorisation, exact to the last digits: refined with residuals in extended precision.
Field refined(const PlateSystem& system, const Field& f) {
  const auto solver = make_plate_solver(available_solvers().front());
  REQUIRE(solver->prepare(system));
  Field w = solver->solve(f).value();
  for (int pass = 0; pass < 4; ++pass) w += solver->solve(residual(system, w, f)).value();
  return w;
}

PlateProblem problem_on(const UnionPlate& plate, const Stiffness& stiffness,
                        const Dynamics& dynamics) {
  EdgeTangents tangents;
  tangents.su0 = Vector3d(1, -2, 0.5);
  tangents.su1 = Vector3d(0, 1, 3);
  tangents.sv0 = Vector3d(-1, 0.25, 2);
  tangents.sv1 = Vector3d(2, 1, -1);
  return {plate.outline(), stiffness, dynamics, tangents,
          100 * Field::Random(plate.grid.node_count(), 3)};
}

}  // namespace

TEST_CASE("rectangles together are as exact as a refined factor", "[plate][schwarz]") {
  const UnionPlate plate = GENERATE(from_range(union_plates(34)));
  const Field load = Field::Random(plate.grid.node_count(), 3);
  const Field f = interior_of(plate.outline(), load);
  SchwarzPlate schwarz;
  for (const Stiffness& stiffness :
       {Stiffness{1, 2, 1}, Stiffness{1, 0, 1}, Stiffness{1, 20, 1}, Stiffness{100, 2, 1},
        Stiffness{1, 2, 100}, Stiffness{1, -1.9, 1}, Stiffness{1, -1.999, 1},
        Stiffness{4, -11.9, 9}}) {
    for (const double shift : {0.0, 1e-3, 1e5, 1e14}) {
      CAPTURE(plate.name, stiffness.b, stiffness.c, stiffness.d, shift);
      const PlateSystem system{plate.outline(), stiffness, shift};
      REQUIRE(prepare(schwarz, system));
      const Field solution = solved(schwarz, plate, load);
      const Field exact = refined(system, f);
      // The last change is 1e-14; the error after it is a tenth of that, or about as large if c is
      // negative.
      const double error = (solution - exact).norm() / exact.norm();
      CHECK(error <= (stiffness.c < 0 ? 1e-13 : 1e-14));
    }
  }
}

TEST_CASE("steps over rectangles are those of a factored matrix", "[plate][schwarz]") {
  const UnionPlate plate = GENERATE(from_range(union_plates(22)));
  const Stiffness stiffness = GENERATE(Stiffness{1, 2, 1}, Stiffness{3, -1, 0.5});
  for (const Dynamics dynamics :
       {Dynamics{40, 20}, Dynamics{0, 20}, Dynamics{40, 0}, Dynamics{0, 0}}) {
    for (const double dt : {1e-6, 1e-3, 1e3}) {
      if (testing::is_sanitized && dt != 1e-3) continue;
      const PlateProblem problem = problem_on(plate, stiffness, dynamics);
      const PlateState state = random_state(plate.grid);
      const auto schwarz = make_schwarz_solver();
      const auto direct = make_plate_solver(SolverChoice::Eigen);
      for (const int count : {1, 2, 9}) {
        CAPTURE(plate.name, dynamics.density, dynamics.damping, dt, count);
        const PlateState a = schwarz->advance(problem, {count, dt}, state).value();
        const PlateState b = direct->advance(problem, {count, dt}, state).value();
        // A velocity is a difference divided by dt, so it has the rounding errors of the
        // displacement divided by dt.
        const double scale = b.displacement.norm();
        CHECK((a.displacement - b.displacement).norm() <= 1e-11 * scale);
        CHECK((a.velocity - b.velocity).norm() <= 1e-11 * (b.velocity.norm() + scale / dt));
        for (int node = 0; node < plate.grid.node_count(); ++node) {
          if (plate.interior[node]) continue;
          REQUIRE(a.displacement.row(node) == state.displacement.row(node));
          REQUIRE(a.velocity.row(node).isZero(0));
        }
      }
      CHECK(schwarz->counts().factorizations == 1);
      CHECK(schwarz->counts().solves == 12);
    }
  }
}

TEST_CASE("a round over the rectangles is symmetric and positive definite", "[plate][schwarz]") {
  const UnionPlate plate = GENERATE(from_range(union_plates(28)));
  const Stiffness stiffness = GENERATE(Stiffness{1, 2, 1}, Stiffness{2, -2.7, 1});
  for (const double shift : {0.0, 1e6}) {
    CAPTURE(plate.name, shift);
    SchwarzPlate schwarz;
    REQUIRE(prepare(schwarz, {plate.outline(), stiffness, shift}));
    const auto round = [&](const Field& load) {
      Field result = Field::Zero(plate.grid.node_count(), 3);
      schwarz.precondition(load_view(plate, load), view(plate, result));
      return interior_of(plate.outline(), result);
    };
    for (int trial = 0; trial < 5; ++trial) {
      const Field x = Field::Random(plate.grid.node_count(), 3);
      const Field y = Field::Random(plate.grid.node_count(), 3);
      const Field bx = round(x), by = round(y);
      const Field x_in = interior_of(plate.outline(), x);
      const Field y_in = interior_of(plate.outline(), y);
      for (int k = 0; k < 3; ++k) {
        const double xby = x_in.col(k).dot(by.col(k)), ybx = y_in.col(k).dot(bx.col(k));
        const double xbx = x_in.col(k).dot(bx.col(k)), yby = y_in.col(k).dot(by.col(k));
        CHECK(xbx > 0);
        CHECK(yby > 0);
        // The Cauchy-Schwarz inequality gives the scale.
        CHECK(std::abs(xby - ybx) <= 1e-13 * std::sqrt(xbx * yby));
      }
    }
  }
}

TEST_CASE("the rounds do not grow with the plate", "[plate][schwarz]") {
  for (const char* const name : {"L", "T", "plus", "U", "ring", "thin strip", "neck"}) {
    for (const int side : {34, 67, 133, 199}) {
      const auto plates = union_plates(side);
      const UnionPlate& plate = *std::find_if(plates.begin(), plates.end(),
                                              [&](const UnionPlate& p) { return p.name == name; });
      SchwarzPlate schwarz;
      REQUIRE(prepare(schwarz, {plate.outline(), {1, 2, 1}, 0}));
      solved(schwarz, plate, Field::Ones(plate.grid.node_count(), 3));
      CAPTURE(name, side);
      CHECK(schwarz.rounds() >= 2);
      CHECK(schwarz.rounds() <= 20);
    }
  }
}

TEST_CASE("no bit of a union depends on threads or on what was kept", "[plate][schwarz][threads]") {
  const UnionPlate plate = GENERATE(ell(131), union_plates(122)[4]);
  const PlateProblem problem = problem_on(plate, {1.5, 1, 2}, {40, 20});
  const PlateState state = random_state(plate.grid);
  const TimeSteps steps{3, 1e-3};
  const auto plain = make_schwarz_solver();
  const PlateState expected = plain->advance(problem, steps, state).value();
  const auto check = [&](PlateSolver& solver) {
    const PlateState next = solver.advance(problem, steps, state).value();
    CHECK(next.displacement == expected.displacement);
    CHECK(next.velocity == expected.velocity);
  };
  for (const int count : {2, 3, 8}) {
    ThreadPool threads(count);
    check(*make_schwarz_solver({.threads = &threads}));
  }
  if (testing::watches_threads) return;
  // Other coefficients, another outline and a system on which it fails, in between.
  PlateProblem other = problem;
  other.stiffness = {1, 2, 1};
  REQUIRE(plain->advance(other, steps, state));
  check(*plain);
  const UnionPlate smaller = ell(40);
  REQUIRE(plain->advance(problem_on(smaller, {1, 2, 1}, {}), steps, random_state(smaller.grid)));
  check(*plain);
  other.load(plate.grid.node(5, 5), 0) = std::numeric_limits<double>::quiet_NaN();
  (void)plain->advance(other, steps, state);
  check(*plain);
}

TEST_CASE("components are solved as if each were alone", "[plate][schwarz]") {
  const UnionPlate plate = ell(40);
  PlateProblem problem = problem_on(plate, {1, 2, 1}, {40, 20});
  problem.tangents = {};
  const PlateState state = random_state(plate.grid);
  const auto solver = make_schwarz_solver();
  const PlateState all = solver->advance(problem, {3, 1e-3}, state).value();
  for (int k = 0; k < 3; ++k) {
    PlateProblem alone = problem;
    PlateState start{Field::Zero(state.displacement.rows(), 3),
                     Field::Zero(state.displacement.rows(), 3)};
    alone.load.setZero();
    alone.load.col(k) = problem.load.col(k);
    start.displacement.col(k) = state.displacement.col(k);
    start.velocity.col(k) = state.velocity.col(k);
    const PlateState one = solver->advance(alone, {3, 1e-3}, start).value();
    CHECK(one.displacement.col(k) == all.displacement.col(k));
    CHECK(one.displacement.col((k + 1) % 3).isZero(0));
    CHECK(one.velocity.col((k + 1) % 3).isZero(0));
  }
}

TEST_CASE("a union stops when asked to, between rounds too", "[plate][schwarz]") {
  const UnionPlate plate = ell(20);
  const PlateProblem problem = problem_on(plate, {}, {});
  const PlateState state = random_state(plate.grid);
  for (const int after : {1, 2, 7}) {
    int asked = 0;
    const auto solver = make_schwarz_solver({.should_stop = [&] { return ++asked == after; }});
    const auto stopped = solver->advance(problem, {10, 0.1}, state);
    REQUIRE_FALSE(stopped);
    CHECK(stopped.error().code == ErrorCode::Interrupted);
    CHECK(asked == after);
    // A single system too.
    asked = 0;
    REQUIRE(solver->prepare({plate.outline(), {1, 2, 1}, 0}));
    const auto solved = solver->solve(Field::Random(unknown_count(plate.outline()), 3));
    REQUIRE_FALSE(solved);
    CHECK(solved.error().code == ErrorCode::Interrupted);
    CHECK(asked == after);
  }
}

TEST_CASE("what few rounds do not solve is said, and factored", "[plate][schwarz]") {
  const UnionPlate plate = ell(30);
  SchwarzPlate schwarz({}, 2);
  REQUIRE(prepare(schwarz, {plate.outline(), {1, 2, 1}, 0}));
  const Field load = Field::Random(plate.grid.node_count(), 3);
  Field solution = Field::Zero(plate.grid.node_count(), 3);
  const auto failed = schwarz.solve(load_view(plate, load), view(plate, solution));
  REQUIRE_FALSE(failed);
  CHECK(failed.error().code == ErrorCode::SolverFailed);
  CHECK_THAT(failed.error().message, pliant::testing::contains_text("not solved after 2 rounds"));

  const PlateProblem problem = problem_on(plate, {1, 2, 1}, {40, 20});
  const PlateState state = random_state(plate.grid);
  const auto impatient = make_schwarz_solver({}, 2);
  const PlateState fallen_back = impatient->advance(problem, {3, 1e-3}, state).value();
  const auto direct = make_plate_solver(available_solvers().front());
  const PlateState expected = advance_in_steps(*direct, problem, {3, 1e-3}, state).value();
  CHECK(fallen_back.displacement == expected.displacement);
  CHECK(fallen_back.velocity == expected.velocity);
  CHECK(impatient->counts().factorizations == 2);
}

TEST_CASE("rectangles solve a system as factors do", "[plate][schwarz][solver]") {
  const UnionPlate plate = ell(30);
  PlateSystem system{plate.outline(), {1, 2, 1}, 3};
  const Field f = Field::Random(unknown_count(system.outline), 3);
  const Field exact = refined(system, f);
  const auto solver = make_schwarz_solver();
  REQUIRE(solver->prepare(system));
  const Field w = solver->solve(f).value();
  CHECK((w - exact).norm() <= 1e-14 * exact.norm());
  CHECK(solver->counts().solves == 1);
  // Nor does a frame in between change a bit.
  REQUIRE(solver->advance(problem_on(plate, {1, 1, 1}, {}), {2, 0.1}, random_state(plate.grid)));
  REQUIRE(solver->prepare(system));
  CHECK(solver->solve(f).value() == w);

  // Too few rounds, and a matrix that is not positive definite: as the factors.
  const auto impatient = make_schwarz_solver({}, 2);
  const auto direct = make_plate_solver(available_solvers().front());
  REQUIRE(direct->prepare(system));
  REQUIRE(impatient->prepare(system));
  for (int k = 0; k < 2; ++k) CHECK(impatient->solve(f).value() == direct->solve(f).value());
  CHECK(impatient->counts().factorizations == 2);
  system.stiffness.c = -40;
  const auto failed = impatient->prepare(system), expected = direct->prepare(system);
  REQUIRE_FALSE(failed);
  CHECK(failed.error().message == expected.error().message);
}

TEST_CASE("numbers that are none end the rounds", "[plate][schwarz]") {
  const UnionPlate plate = ell(30);
  SchwarzPlate schwarz;
  REQUIRE(prepare(schwarz, {plate.outline(), {1, 2, 1}, 0}));
  Field load = Field::Ones(plate.grid.node_count(), 3);
  load(plate.grid.node(3, 4), 1) = std::numeric_limits<double>::infinity();
  Field solution = Field::Zero(plate.grid.node_count(), 3);
  const auto failed = schwarz.solve(load_view(plate, load), view(plate, solution));
  REQUIRE_FALSE(failed);
  CHECK(failed.error().code == ErrorCode::SolverFailed);
  load.setZero();
  solution.setOnes();
  REQUIRE(schwarz.solve(load_view(plate, load), view(plate, solution)));
  CHECK(interior_of(plate.outline(), solution).isZero(0));
}

TEST_CASE("rectangles keep within the memory they may have", "[plate][schwarz]") {
  const UnionPlate plate = ell(101);
  const PlateProblem problem = problem_on(plate, {}, {});
  const PlateState state = random_state(plate.grid);
  for (const std::size_t bytes : {std::size_t{1} << 20, std::size_t{3} << 20}) {
    MemoryBudget small(bytes);
    const auto refused = make_schwarz_solver({.memory = &small})->advance(problem, {1, 1}, state);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::OutOfMemory);
    CHECK(small.available() == small.total());
  }
  MemoryBudget enough(std::size_t{64} << 20);
  const auto solver = make_schwarz_solver({.memory = &enough});
  REQUIRE(solver->advance(problem, {1, 1}, state));
  CHECK(enough.total() - enough.available() == solver->memory());
  CHECK(solver->memory() <=
        sizeof(double) * 60 * static_cast<std::size_t>(plate.grid.node_count()));
}

TEST_CASE("large unions go to rectangles by themselves", "[plate][schwarz][solver]") {
  CHECK_FALSE(worth_iterating(10'000, {1, 2, 1}));
  CHECK(worth_iterating(1'000'000, {1, 2, 1}));
  CHECK(worth_iterating(1'000'000, {1, -1.9, 1}));
  CHECK_FALSE(worth_iterating(1'000'000, {1, -1.99, 1}));

  const SolverChoice direct = available_solvers().front();
  for (const int side : {101, 461}) {
    if (testing::is_sanitized && side > 101) continue;
    const UnionPlate plate = ell(side);
    const PlateProblem problem = problem_on(plate, {}, {});
    const PlateState state = random_state(plate.grid);
    const auto displacement = [&](std::unique_ptr<PlateSolver> solver) {
      return solver->advance(problem, {1, 0.01}, state).value().displacement;
    };
    const bool is_large = worth_iterating(unknown_count(plate.outline()), {1, 2, 1});
    CHECK(is_large == (side == 461));
    const Field expected =
        displacement(is_large ? make_schwarz_solver() : make_plate_solver(direct));
    for (const SolverChoice choice : {SolverChoice::Auto, SolverChoice::Spectral})
      CHECK(displacement(make_plate_solver(choice)) == expected);
  }
}
