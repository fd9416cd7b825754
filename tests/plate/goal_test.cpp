#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "pliant/plate/plate_solver.hpp"
#include "pliant/plate/vibration.hpp"
#include "support/catch.hpp"
#include "support/dense.hpp"
#include "support/plates.hpp"

using namespace pliant;
using namespace pliant::testing;

// A goal: g w beside the plate's own terms, docs/model.md, "Goals".

namespace {

constexpr Edges pinned = {Edge::Pinned, Edge::Pinned, Edge::Pinned, Edge::Pinned};
constexpr Edges free_edges = {Edge::Free, Edge::Free, Edge::Free, Edge::Free};
constexpr Edges mixed = {Edge::Clamped, Edge::Free, Edge::Pinned, Edge::Free};

TimeSteps in_one(double length) { return {1, length, Integrator::Exact}; }

PlateProblem pulled(const Outline& outline, double goal, const Dynamics& dynamics,
                    const Field& load) {
  PlateProblem problem{outline, {1.3, 2.1, 0.8}, dynamics, {}, load, 0.25};
  problem.first_load = load;
  problem.goal = goal;
  return problem;
}

std::shared_ptr<const NodeFactors> goals_of(std::vector<double> factors) {
  auto all = std::make_shared<NodeFactors>();
  all->goal = std::move(factors);
  return all;
}

std::shared_ptr<const NodeFactors> even_goals(const Grid& grid, double factor = 1) {
  return goals_of(std::vector<double>(static_cast<std::size_t>(grid.node_count()), factor));
}

PlateState advanced(const PlateProblem& problem, const TimeSteps& steps, const PlateState& state,
                    SolverChoice choice = SolverChoice::Auto) {
  return make_plate_solver(choice)->advance(problem, steps, state).value();
}

// A rim without any displacement.
PlateState at_random(const Outline& outline) {
  const Grid& grid = outline.grid();
  const PlateState any = random_state(grid);
  const Field zero = Field::Zero(grid.node_count(), 3);
  return {with_interior(outline, zero, interior_of(outline, any.displacement)),
          with_interior(outline, zero, interior_of(outline, any.velocity))};
}

double smallest(const Outline& outline, double goal, SolverChoice choice = SolverChoice::Auto,
                std::shared_ptr<const NodeFactors> factors = {}) {
  PlateSystem system{outline, {1.3, 2.1, 0.8}};
  system.poisson = 0.25;
  system.factors = std::move(factors);
  system.goal = goal;
  const auto solver = make_plate_solver(choice);
  return smallest_eigenvalue(*solver, system).value();
}

double largest(const Field& field) { return field.cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("a load on a pinned rectangle with a goal is the series with g in its denominator",
          "[plate][goal]") {
  constexpr double pi = std::numbers::pi;
  const SolverChoice choice = GENERATE(from_range(available_solvers()));
  for (const double goal : {0.0, 300.0, 2e4}) {
    const auto error = [&](int count) {
      const Grid grid{count, 2 * count - 1, 1.0 / (count - 1), 0.75 / (count - 1)};
      const Outline outline(grid, pinned);
      const Field load = Field::Ones(grid.node_count(), 3);
      const Field zero = Field::Zero(grid.node_count(), 3);
      const Field w = advanced(pulled(outline, goal, {0, 0}, load), {1, 1.0}, {zero, zero}, choice)
                          .displacement;
      double series = 0;
      for (int m = 1; m < 400; m += 2) {
        for (int n = 1; n < 400; n += 2) {
          const double x = pi * m * (pi * m), y = pi * n / 1.5 * (pi * n / 1.5);
          const double sign = (m + n) % 4 == 2 ? 1 : -1;
          series +=
              sign * 16 / (pi * pi * m * n) / (1.3 * x * x + 2.1 * x * y + 0.8 * y * y + goal);
        }
      }
      return std::abs(w(grid.node((count - 1) / 2, count - 1), 1) / series - 1);
    };
    const double coarse = error(17), fine = error(33);
    CAPTURE(goal, coarse, fine);
    CHECK(std::log2(coarse / fine) > 1.8);
    CHECK(fine < 0.01);
  }
}

TEST_CASE("a goal adds itself to each eigenvalue", "[plate][goal][vibration]") {
  const SolverChoice choice = GENERATE(from_range(available_solvers()));
  const Grid ring{9, 11, 0.1, 0.1, true, false};
  for (const Outline& outline : {Outline(unit_grid(11, 13)), Outline(unit_grid(10, 12), pinned),
                                 Outline(ring), Outline(unit_grid(9, 10), mixed)}) {
    const double without = smallest(outline, 0, choice);
    for (const double goal : {1e-3, 40.0, 1e5})
      CHECK_THAT(smallest(outline, goal, choice), WithinRel(without + goal, 1e-7));
    const auto twice = even_goals(outline.grid(), 2);
    CHECK_THAT(smallest(outline, 40, choice, twice), WithinRel(without + 80, 1e-7));
  }
}

TEST_CASE("motions that no goal and no held node resists are left out, and no others",
          "[plate][goal][vibration]") {
  const Grid open = unit_grid(7, 6);
  const Grid ring{9, 6, 0.2, 0.25, true, false};
  struct Case {
    Outline outline;
    std::vector<std::pair<int, int>> nodes;  // with a goal
    int rigid;                               // motions left
  };
  const std::vector<Case> cases = {
      {{open, free_edges}, {}, 3},
      {{open, free_edges}, {{3, 2}}, 2},
      {{open, free_edges}, {{1, 1}, {2, 2}, {4, 4}}, 1},
      {{open, free_edges}, {{1, 1}, {2, 2}, {3, 4}}, 0},
      {{open, {Edge::Pinned, Edge::Free, Edge::Free, Edge::Free}}, {}, 1},
      {{open, {Edge::Pinned, Edge::Free, Edge::Free, Edge::Free}}, {{2, 5}}, 0},
      {{ring, free_edges}, {}, 2},
      {{ring, free_edges}, {{0, 3}, {4, 3}}, 1},
      {{ring, free_edges}, {{0, 3}, {4, 4}}, 0},
      {{Grid{9, 6, 0.2, 0.25, true, true}}, {{5, 5}}, 0}};
  for (const auto& [outline, nodes, rigid] : cases) {
    const Grid& grid = outline.grid();
    std::vector<double> factors(static_cast<std::size_t>(grid.node_count()));
    for (const auto& [i, j] : nodes) factors[grid.node(i, j)] = 1.5;
    PlateSystem system{outline, {1.3, 2.1, 0.8}};
    system.poisson = 0.25;
    system.factors = goals_of(factors);
    system.goal = 60;
    CAPTURE(grid.is_closed_u, nodes.size());
    CHECK(is_held(system) == (rigid == 0));
    const Eigen::MatrixXd upper = assemble_upper(system);
    const Eigen::MatrixXd masses = GridAssembly(system).weights().masses.asDiagonal();
    const Eigen::VectorXd all = modes_of(upper.selfadjointView<Eigen::Upper>(), masses).values;
    if (rigid > 0) REQUIRE(std::abs(all(rigid - 1)) < 1e-8 * all(rigid));
    CHECK_THAT(smallest(outline, 60, SolverChoice::Auto, system.factors),
               WithinRel(all(rigid), 1e-7));
  }
  // The same with held nodes in place of these, or together.
  for (const auto& [outline, nodes, rigid] : cases) {
    const Grid& grid = outline.grid();
    if (nodes.empty()) continue;
    InteriorMask mask(static_cast<std::size_t>(grid.node_count()), 0);
    outline.for_each_run([&](const Outline::Run& run) {
      for (int i = run.i0; i <= run.i1; ++i) mask[grid.node(i, run.j)] = 1;
    });
    std::vector<double> factors(mask.size());
    for (const bool are_all : {true, false}) {
      for (const auto& [i, j] : nodes) mask[grid.node(i, j)] = 0;
      if (!are_all) {
        mask[grid.node(nodes[0].first, nodes[0].second)] = 1;
        factors[grid.node(nodes[0].first, nodes[0].second)] = 1.5;
      }
      PlateSystem system{Outline(grid, outline.edges(), mask), {1.3, 2.1, 0.8}};
      system.poisson = 0.25;
      system.factors = goals_of(factors);
      system.goal = are_all ? 0 : 60;
      CHECK(is_held(system) == (rigid == 0));
      const Eigen::MatrixXd upper = assemble_upper(system);
      const Eigen::MatrixXd masses = GridAssembly(system).weights().masses.asDiagonal();
      const Eigen::VectorXd all = modes_of(upper.selfadjointView<Eigen::Upper>(), masses).values;
      if (rigid > 0) REQUIRE(std::abs(all(rigid - 1)) < 1e-8 * all(rigid));
      const auto solver = make_plate_solver(SolverChoice::Auto);
      CHECK_THAT(smallest_eigenvalue(*solver, system).value(), WithinRel(all(rigid), 1e-7));
    }
  }
  // Everywhere: g, three times.
  CHECK_THAT(smallest({unit_grid(17, 14), free_edges}, 0.7), WithinRel(0.7, 1e-7));
}

TEST_CASE("a mode that a goal pulls back moves as in closed form", "[plate][goal][exact]") {
  constexpr double goal = 900, rho = 0.4, eta = 3, time = 0.37;
  struct Case {
    SolverChoice choice;
    Outline outline;
  };
  const Grid grid = unit_grid(10, 9);
  for (const auto& [choice, outline] :
       {Case{SolverChoice::Spectral, grid}, Case{available_solvers().front(), grid},
        Case{SolverChoice::Auto, {grid, pinned}}, Case{SolverChoice::Auto, {grid, mixed}}}) {
    const PlateProblem problem =
        pulled(outline, goal, {rho, eta}, Field::Zero(grid.node_count(), 3));
    PlateSystem system = problem.system(1);
    system.shift = system.drag = system.goal = 0;
    const Eigen::MatrixXd upper = assemble_upper(system);
    const Eigen::MatrixXd masses = GridAssembly(system).weights().masses.asDiagonal();
    const auto modes = modes_of(upper.selfadjointView<Eigen::Upper>(), masses);
    const double lambda = modes.values(1) + goal;
    const Field zero = Field::Zero(grid.node_count(), 3);
    const Field shape = with_interior(outline, zero, modes.vectors.col(1).replicate(1, 3));
    const PlateState end = advanced(problem, in_one(time), {shape, zero}, choice);
    const double decay = eta / (2 * rho), omega = std::sqrt(lambda / rho - decay * decay);
    const double q =
        std::exp(-decay * time) * (std::cos(omega * time) + decay / omega * std::sin(omega * time));
    const double v = -std::exp(-decay * time) * lambda / rho / omega * std::sin(omega * time);
    CHECK(largest(end.displacement - q * shape) < 1e-6 * largest(shape));
    CHECK(largest(end.velocity - v * shape) < 1e-5 * omega * largest(shape));
  }
}

TEST_CASE("each way to solve a plate has the same goal, as a number and as a map of ones",
          "[plate][goal]") {
  const Grid grid = unit_grid(12, 11);
  constexpr double time = 0.04;
  const std::vector<TimeSteps> all_steps = {
      {3, time / 3}, {3, time / 3, Integrator::Newmark}, in_one(time)};
  for (const Edges& edges : {Edges{}, pinned, free_edges, mixed}) {
    const Outline outline(grid, edges);
    const PlateState state = at_random(outline);
    PlateProblem problem = pulled(outline, 5e3, {0.6, 2}, Field::Random(grid.node_count(), 3));
    for (const TimeSteps& steps : all_steps) {
      problem.factors = nullptr;
      const PlateState expected = advanced(problem, steps, state);
      const double bound = (steps.are_exact() ? 1e-6 : 1e-8) * largest(expected.displacement);
      problem.factors = even_goals(grid);
      CHECK(largest(advanced(problem, steps, state).displacement - expected.displacement) < bound);
      problem.factors = even_goals(grid, 0.25);
      problem.goal *= 4;
      CHECK(largest(advanced(problem, steps, state).displacement - expected.displacement) < bound);
      problem.goal /= 4;
      problem.factors = nullptr;
      for (const SolverChoice choice : available_solvers()) {
        const Field w = advanced(problem, steps, state, choice).displacement;
        CHECK(largest(w - expected.displacement) < bound);
      }
    }
  }
}

TEST_CASE("a step with a goal leaves nothing of its right-hand side", "[plate][goal]") {
  const Grid grid = unit_grid(21, 18);
  std::vector<double> factors;
  for (int node = 0; node < grid.node_count(); ++node) factors.push_back(node % 3);
  for (const Edges& edges : {Edges{}, free_edges}) {
    for (const auto& map : {std::shared_ptr<const NodeFactors>(), goals_of(factors)}) {
      PlateSystem system{Outline(grid, edges), {1.3, 2.1, 0.8}, 2.5, 0.25};
      system.factors = map;
      system.goal = 700;
      // Entry by entry the matrix without a goal, and the shares of area times it.
      PlateSystem without = system;
      without.goal = 0;
      const GridAssembly assembly(system);
      Eigen::VectorXd goals = 700 * assembly.weights().areas;
      if (map) {
        const Field all =
            Eigen::Map<const Eigen::VectorXd>(factors.data(), grid.node_count()).replicate(1, 3);
        goals = goals.cwiseProduct(interior_of(system.outline, all).col(0));
      }
      const Eigen::MatrixXd difference = assemble_upper(system) - assemble_upper(without);
      const Eigen::MatrixXd expected = goals.asDiagonal();
      CHECK((difference - expected).cwiseAbs().maxCoeff() < 1e-9);
      const auto solver = make_plate_solver(SolverChoice::Auto);
      REQUIRE(solver->prepare(system));
      const Field f = Field::Random(system.outline.unknown_count(), 3);
      const Field w = solver->solve(f).value();
      CHECK(largest(residual(system, w, f)) < 1e-6);
    }
  }
}

TEST_CASE("a goal of 0 with a map leaves every bit of a plate", "[plate][goal]") {
  const Grid grid = unit_grid(9, 8);
  const SolverChoice choice = available_solvers().front();
  for (const Edges& edges : {Edges{}, mixed}) {
    const Outline outline(grid, edges);
    const PlateState state = at_random(outline);
    PlateProblem problem = pulled(outline, 0, {0.6, 2}, Field::Random(grid.node_count(), 3));
    const Field expected = advanced(problem, {3, 0.01}, state, choice).displacement;
    problem.factors = even_goals(grid, 3);
    CHECK(advanced(problem, {3, 0.01}, state, choice).displacement == expected);
  }
}
