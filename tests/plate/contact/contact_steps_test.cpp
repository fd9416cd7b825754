#include <cmath>
#include <numbers>
#include <vector>

#include "plate/contact/ground.hpp"
#include "pliant/plate/plate_solver.hpp"
#include "support/catch.hpp"
#include "support/plates.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

constexpr Dynamics no_dynamics = {0, 0};

// Under an even load along y.
PlateProblem loaded(const Outline& outline, const Dynamics& dynamics, double load) {
  PlateProblem problem{outline, {1, 2, 1}, dynamics, {}, {}, 0};
  problem.load = Field::Zero(outline.grid().node_count(), 3);
  problem.load.col(1).setConstant(load);
  return problem;
}

PlateState at_rest(const Grid& grid) {
  return {Field::Zero(grid.node_count(), 3), Field::Zero(grid.node_count(), 3)};
}

// A beam between two clamps, 1 long, whose long edges are free.
Outline beam(int nodes) {
  const Grid grid{nodes, 9, 1.0 / (nodes - 1), 1.0 / (nodes - 1)};
  return {grid, Edges{Edge::Clamped, Edge::Clamped, Edge::Free, Edge::Free}};
}

struct OnFloor {
  double error = 0;    // as a part of the floor's depth
  double at_edge = 0;  // the force of each edge of the floor
  double inside = 0;   // on a node in its middle
};

// Pressed on a floor at -depth: it lifts off at a = (72 depth/load)^(1/4) from the clamps.
OnFloor press(int nodes, double load, double depth) {
  const Outline outline = beam(nodes);
  const Grid& grid = outline.grid();
  PlateProblem problem = loaded(outline, no_dynamics, -load);
  Ground floor([&](int) { return -depth; });
  problem.contact = &floor;
  const auto solver = make_plate_solver();
  const auto state = solver->advance(problem, {1, 1}, at_rest(grid));
  REQUIRE(state);
  const double a = std::sqrt(std::sqrt(72 * depth / load));
  OnFloor found;
  double total = 0;
  for (int i = 0; i < nodes; ++i) {
    const double x = std::min(i, nodes - 1 - i) * grid.hu, s = std::max(0.0, a - x);
    const double exact = -depth + load * a * s * s * s / 18 - load * s * s * s * s / 24;
    const double w = state->displacement(grid.node(i, 4), 1);
    found.error = std::max(found.error, std::abs(w - exact) / depth);
  }
  // Columns between the clamps, each of 9 rows.
  const auto force_of = [&](int i) {
    return floor.forces()[static_cast<std::size_t>(4 * (nodes - 2) + i - 1)];
  };
  for (int i = 1; i < nodes - 1; ++i) total += force_of(i) * grid.hu;
  found.inside = force_of((nodes - 1) / 2);
  found.at_edge = (total - load * (1 - 2 * a)) / 2;
  return found;
}

}  // namespace

TEST_CASE("a beam lies on a floor as the exact one does", "[plate][contact]") {
  const double load = 7, depth = 1e-3;
  const OnFloor coarse = press(41, load, depth), fine = press(161, load, depth);
  CHECK(coarse.error < 0.02);
  CHECK(fine.error < 0.0014);
  // The error falls with the square of the spacing.
  CHECK(coarse.error / fine.error > 12);
  const double a = std::sqrt(std::sqrt(72 * depth / load));
  CHECK_THAT(fine.inside, WithinRel(load, 1e-5));
  CHECK_THAT(fine.at_edge, WithinRel(load * a / 3, 0.01));
}

TEST_CASE("a disc on a point is the exact one, and so is its force", "[plate][contact]") {
  const int half = 60;
  const Grid grid = unit_grid(2 * half + 3, 2 * half + 3);
  const double radius = half * grid.hu, height = 0.3;
  InteriorMask mask(static_cast<std::size_t>(grid.node_count()), 0);
  const int middle = half + 1;
  for (int j = 1; j < grid.rows - 1; ++j) {
    for (int i = 1; i < grid.columns - 1; ++i) {
      const int di = i - middle, dj = j - middle;
      mask[static_cast<std::size_t>(grid.node(i, j))] = di * di + dj * dj < half * half;
    }
  }
  const Outline outline(grid, mask);
  const int top = numbers_of_unknowns(outline)[static_cast<std::size_t>(grid.node(middle, middle))];
  Ground point([&](int k) { return k == top ? height : -1; });
  PlateProblem problem = loaded(outline, no_dynamics, 0);
  problem.contact = &point;
  const auto state = make_plate_solver()->advance(problem, {1, 1}, at_rest(grid));
  REQUIRE(state);
  for (int i = 1; i < half; ++i) {
    const double r = double(i) / half;
    const double exact = height * (1 - r * r + 2 * r * r * std::log(r));
    // The outline is one of cells, half of one too large at most.
    CHECK_THAT(state->displacement(grid.node(middle + i, middle), 1),
               WithinAbs(exact, 0.02 * height));
  }
  const double force = point.forces()[static_cast<std::size_t>(top)] * grid.hu * grid.hv;
  CHECK_THAT(force, WithinRel(16 * std::numbers::pi * height / (radius * radius), 0.03));
}

TEST_CASE("where nothing touches, a step has the bits of one without contact", "[plate][contact]") {
  const Grid grid = unit_grid(20, 14);
  for (const Integrator integrator : {Integrator::BackwardEuler, Integrator::Newmark}) {
    for (const SolverChoice choice : available_solvers()) {
      PlateProblem problem = loaded(grid, {1, 0.2}, -3);
      PlateState state = random_state(grid);
      clear_rim(grid, state.velocity);
      const TimeSteps steps{4, 0.01, integrator};
      const auto free = make_plate_solver(choice)->advance(problem, steps, state);
      Ground far_below([](int) { return -100; });
      problem.contact = &far_below;
      const auto met = make_plate_solver(choice)->advance(problem, steps, state);
      REQUIRE(free);
      REQUIRE(met);
      CHECK(free->displacement == met->displacement);
      CHECK(free->velocity == met->velocity);
    }
  }
}

TEST_CASE("every solver finds the same contact", "[plate][contact]") {
  const Grid grid = unit_grid(24, 17);
  for (const Integrator integrator : {Integrator::BackwardEuler, Integrator::Newmark}) {
    std::vector<PlateState> found;
    for (const SolverChoice choice : {SolverChoice::Spectral, SolverChoice::Supernodal}) {
      PlateProblem problem = loaded(grid, {1, 0.2}, -300);
      Ground bowl([&](int k) {
        const double x = (k % 22) * grid.hu - 0.4, y = (k / 22) * grid.hv - 0.3;
        return -0.02 + x * x + y * y;
      });
      problem.contact = &bowl;
      const auto state =
          make_plate_solver(choice)->advance(problem, {6, 0.02, integrator}, at_rest(grid));
      REQUIRE(state);
      found.push_back(*state);
    }
    const double peak = found[0].displacement.cwiseAbs().maxCoeff();
    CHECK(peak > 0.02);
    CHECK((found[0].displacement - found[1].displacement).cwiseAbs().maxCoeff() < 1e-9 * peak);
  }
}

TEST_CASE("what is pressed on the ground comes no lower, and rests", "[plate][contact]") {
  const Grid grid = unit_grid(31, 31);
  PlateProblem problem = loaded(grid, {1, 0}, -4000);
  Ground floor([](int) { return -0.05; });
  problem.contact = &floor;
  PlateState state = at_rest(grid);
  const auto solver = make_plate_solver();
  for (int frame = 0; frame < 30; ++frame) {
    auto next = solver->advance(problem, {3, 0.01}, std::move(state));
    REQUIRE(next);
    state = *std::move(next);
    CHECK(state.displacement.col(1).minCoeff() > -0.05 - 1e-13);
  }
  CHECK(state.velocity.cwiseAbs().maxCoeff() < 1e-3);
  double most = 0;
  for (const double force : floor.forces()) most = std::max(most, force);
  CHECK(most > 0);
}
