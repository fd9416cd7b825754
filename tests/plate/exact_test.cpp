#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "pliant/core/memory_budget.hpp"
#include "pliant/core/thread_pool.hpp"
#include "pliant/plate/exact/pade.hpp"
#include "pliant/plate/kernels/kernels.hpp"
#include "pliant/plate/plate_solver.hpp"
#include "support/catch.hpp"
#include "support/dense.hpp"
#include "support/exact_solution.hpp"
#include "support/plates.hpp"
#include "support/sanitized.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

struct ExactCase {
  std::string name;
  SolverChoice choice;
  Outline outline;
};

Outline corner_shape(int columns, int rows) {
  const Grid grid = unit_grid(columns, rows);
  InteriorMask mask(static_cast<std::size_t>(grid.node_count()));
  for (int j = 1; j + 1 < rows; ++j) {
    for (int i = 1; i + 1 < columns; ++i) {
      mask[grid.node(i, j)] = i < columns / 2 || j < rows / 2;
    }
  }
  return {grid, mask};
}

// Small with a sanitizer: the solutions that they are compared with are dense.
std::vector<ExactCase> exact_cases() {
  const Grid grid = is_sanitized ? unit_grid(6, 7) : unit_grid(12, 10);
  return {{"sine space", SolverChoice::Spectral, grid},
          {"factor", available_solvers().front(), grid},
          {"mask", SolverChoice::Auto, is_sanitized ? corner_shape(7, 6) : corner_shape(10, 9)}};
}

PlateProblem changing(const Outline& outline, const Stiffness& stiffness, const Dynamics& dynamics,
                      const Field& first_load, const Field& load,
                      const EdgeTangents& first_tangents = {}, const EdgeTangents& tangents = {}) {
  PlateProblem problem{outline, stiffness, dynamics, tangents, load};
  problem.first_load = first_load;
  problem.first_tangents = first_tangents;
  return problem;
}

TimeSteps exactly(double length) { return {1, length, Integrator::Exact}; }

bool have_the_same_bits(const Field& a, const Field& b) {
  return a.rows() == b.rows() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

double apart(const Field& a, const Eigen::MatrixXd& b) { return (a - b).cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("the exact integrator has the error of a millionth in each of 250 frames",
          "[plate][exact]") {
  const Stiffness stiffness{1.5, 0.5, 2};
  for (const auto& [name, choice, of_case] : exact_cases()) {
    const Outline& outline = of_case;
    const Eigen::MatrixXd L = dense_operator({outline, stiffness, 0});
    const auto n = L.rows();
    const auto nodes = outline.grid().node_count();
    const double slowest = std::sqrt(eigenvalues_of(L)[0]);
    const Field shape = Field::Random(nodes, 3);
    EdgeTangents tangents;
    if (outline.is_rectangle()) tangents.su0 = {1, -2, 0.5};
    // Radians of the slowest mode in a frame; damping; frames until the load is whole, or -1: it is
    // there in the first frame only.
    struct Motion {
      double density, angle, damping;
      int rise;
    };
    for (const auto& [density, angle, damping, frames] :
         {Motion{2, 0.1, 0, 24}, Motion{2, 0.5, 0, 24}, Motion{2, 0.5, 0, 0}, Motion{2, 2, 0, 10},
          Motion{2, 5, 0, 0}, Motion{2, 0.5, 0.3, 0}, Motion{2, 0.5, 4, 5}, Motion{2, 0.1, 0, -1},
          Motion{2, 0.5, 0, -1}, Motion{2, 0.5, 0.3, -1}, Motion{1e-6, 0.5, 1e4, 5},
          Motion{0, 0.3, 1, 5}, Motion{0, 30, 1, 0}}) {
      if (is_sanitized && (angle != 0.5 || damping > 0.1)) continue;
      const int rise = frames;
      CAPTURE(name, density, angle, damping, rise);
      // Without density the slowest mode loses the part e^-angle in a frame.
      const bool swings = density > 0;
      const double T =
          swings ? angle * std::sqrt(density) / slowest : angle * damping / (slowest * slowest);
      const Dynamics dynamics{density,
                              swings ? 2 * damping * slowest * std::sqrt(density) : damping};
      const ExactSolution exact(L, Eigen::VectorXd::Constant(n, dynamics.density),
                                Eigen::VectorXd::Constant(n, dynamics.damping), T);
      const auto solver = make_plate_solver(choice);
      PlateState state{Field::Zero(nodes, 3), Field::Zero(nodes, 3)};
      // The rim is displaced.
      if (rise > 0) {
        state.displacement =
            with_interior(outline, 1e-3 * Field::Random(nodes, 3), Field::Zero(n, 3));
      }
      const Field rim = state.displacement;
      Eigen::MatrixXd w = Eigen::MatrixXd::Zero(n, 3), v = w;
      double worst = 0, peak = 0, worst_velocity = 0, fastest = 0;
      const auto part = [&](int frame) {
        if (rise < 0) return frame == 1 ? 1.0 : 0.0;
        return std::min(1.0, rise ? double(frame) / rise : 1);
      };
      const auto tangents_at = [&](int frame) {
        const double s = 1e-3 * part(frame);
        return EdgeTangents{s * tangents.su0, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
      };
      const auto force_at = [&](int frame) -> Field {
        return interior_of(outline, Field(part(frame) * shape)) -
               apply_stencil(outline, stiffness, tangents_at(frame), rim);
      };
      for (int frame = 0; frame < (is_sanitized ? 4 : 250); ++frame) {
        const int before = std::max(0, frame - 1);
        const PlateProblem problem =
            changing(outline, stiffness, dynamics, part(before) * shape, part(frame) * shape,
                     tangents_at(before), tangents_at(frame));
        state = solver->advance(problem, exactly(T), std::move(state)).value();
        exact.advance(force_at(before), force_at(frame), w, v);
        worst = std::max(worst, apart(interior_of(outline, state.displacement), w));
        peak = std::max(peak, w.cwiseAbs().maxCoeff());
        worst_velocity = std::max(worst_velocity, apart(interior_of(outline, state.velocity), v));
        fastest = std::max(fastest, v.cwiseAbs().maxCoeff());
      }
      CHECK(peak > 0);
      CHECK(worst < 1e-6 * peak);
      CHECK(worst_velocity < 1e-5 * std::max(fastest, peak / T));
    }
  }
}

TEST_CASE("the exact integrator keeps the energy of an undamped plate", "[plate][exact]") {
  for (const auto& [name, choice, of_case] : exact_cases()) {
    const Outline& outline = of_case;
    CAPTURE(name);
    const double density = 2, T = 0.05;
    const Eigen::MatrixXd L = dense_operator({outline, {1.5, 0.5, 2}, 0});
    const auto n = L.rows();
    const Field load = with_interior(outline, Field::Zero(outline.grid().node_count(), 3),
                                     1e3 * Field::Random(n, 3));
    // It begins in equilibrium, and is pushed.
    PlateState state{Field::Zero(load.rows(), 3), Field::Zero(load.rows(), 3)};
    const Field still = L.llt().solve(interior_of(outline, load));
    state.displacement = with_interior(outline, state.displacement, still);
    state.velocity = with_interior(outline, state.velocity, Field(20 * still));
    double largest = 0;
    const auto energy = [&] {
      const Field w = interior_of(outline, state.displacement);
      const Field v = interior_of(outline, state.velocity);
      const double sum = density / 2 * v.squaredNorm() + w.cwiseProduct(L * w).sum() / 2;
      largest = std::max(largest, sum);
      return sum - w.cwiseProduct(interior_of(outline, load)).sum();
    };
    const double first = energy();
    const auto solver = make_plate_solver(choice);
    const PlateProblem problem = changing(outline, {1.5, 0.5, 2}, {density, 0}, load, load);
    double worst = 0;
    for (int frame = 0; frame < (is_sanitized ? 10 : 250); ++frame) {
      state = solver->advance(problem, exactly(T), std::move(state)).value();
      worst = std::max(worst, std::abs(energy() - first));
    }
    CHECK(worst < 1e-6 * largest);
  }
}

// From rest, a motion is tiny in the first step: its errors count beside what it becomes.
TEST_CASE("a motion that begins needs few steps", "[plate][exact]") {
  const auto choice = GENERATE(SolverChoice::Spectral, available_solvers().front());
  const Grid grid = unit_grid(31, 31);
  const Field load = sampled(grid, [](double u, double v) {
    return std::abs(u - 0.42) < 0.2 && std::abs(v - 0.55) < 0.15 ? 1 : 0;
  });
  constexpr double angle = 0.5, slowest = 36;
  constexpr long later = 24;  // solves of three steps
  const auto solver = make_plate_solver(choice);
  PlateState state{0 * load, 0 * load};
  for (int frame = 1; frame <= 24; ++frame) {
    const auto before = solver->counts().solves;
    const PlateProblem problem =
        changing(grid, {}, {1, 0}, (frame - 1) / 24.0 * load, frame / 24.0 * load);
    state = solver->advance(problem, exactly(angle / slowest), std::move(state)).value();
    CAPTURE(frame);
    CHECK(solver->counts().solves - before <= 10 * later);
  }
}

TEST_CASE("exact steps in sine space are those of factors", "[plate][exact]") {
  const auto [columns, rows] = GENERATE(std::pair{9, 9}, std::pair{33, 21}, std::pair{24, 70});
  const Grid grid = unit_grid(columns, rows);
  const Stiffness stiffness{1.5, GENERATE(3.0, -1.0), 2};
  const Dynamics dynamics{2, GENERATE(0.0, 5.0)};
  CAPTURE(columns, rows, stiffness.c, dynamics.damping);
  if (is_sanitized && columns > 9) return;
  const EdgeTangents first_tangents{{1, 0, 2}, {0, 0, 0}, {0.5, 0, 0}, {0, 0, 0}};
  const EdgeTangents tangents{{0, 3, 0}, {1, 1, 0}, {0, 0, 0}, {0, 0, -2}};
  const Field first_load = sampled(grid, [](double u, double v) { return 900 * u * (1 - v); });
  const Field load = sampled(grid, [](double u, double v) { return 700 * v * v - 50 * u; });
  PlateState a{sampled(grid, [](double u, double v) { return u * v * (1 + u); }),
               sampled(grid, [](double u, double v) { return u - 2 * v; })};
  PlateState b = a;
  const auto sines = make_plate_solver(SolverChoice::Spectral);
  const auto factors = make_plate_solver(available_solvers().front());
  for (int frame = 0; frame < 4; ++frame) {
    const PlateProblem problem =
        changing(grid, stiffness, dynamics, first_load, load, first_tangents, tangents);
    a = sines->advance(problem, exactly(0.02), std::move(a)).value();
    b = factors->advance(problem, exactly(0.02), std::move(b)).value();
    CHECK((a.displacement - b.displacement).norm() < 1e-8 * b.displacement.norm());
    CHECK((a.velocity - b.velocity).norm() < 1e-8 * b.velocity.norm());
  }
}

TEST_CASE("no bit of exact steps depends on threads, vectors or what was solved before",
          "[plate][exact][threads]") {
  const bool is_mask = GENERATE(false, true);
  const Outline outline = is_mask ? corner_shape(60, 70) : Outline(unit_grid(131, 97));
  const Field load = 1e3 * Field::Random(outline.grid().node_count(), 3);
  const PlateProblem problem = changing(outline, {1.5, 1, 2}, {40, 20}, -load, load);
  const PlateState start{
      with_interior(outline, 0 * load, Field::Random(outline.unknown_count(), 3)),
      with_interior(outline, 0 * load, Field::Random(outline.unknown_count(), 3))};
  constexpr double length = 1e-4;  // some substeps
  const auto advance = [&](PlateSolver& solver) {
    return solver.advance(problem, exactly(length), start).value();
  };
  const auto plain = make_plate_solver();
  const PlateState expected = advance(*plain);
  const auto check = [&](PlateSolver& solver) {
    const PlateState next = advance(solver);
    CHECK(next.displacement == expected.displacement);
    CHECK(next.velocity == expected.velocity);
  };
  for (const int count : {2, 5}) {
    ThreadPool threads(count);
    check(*make_plate_solver(SolverChoice::Auto, {.threads = &threads}));
  }
  if (watches_threads) return;
  for (int which = 0; runnable_kernels(which); ++which) {
    CAPTURE(runnable_kernels(which)->name);
    check(*make_plate_solver(SolverChoice::Auto, {.most_lanes = runnable_kernels(which)->lanes}));
  }
  check(*plain);
  // Other plates in between, by the same solver.
  PlateProblem other = problem;
  other.dynamics.damping = 0;
  REQUIRE(plain->advance(other, exactly(3 * length), start));
  REQUIRE(plain->advance(problem, {3, 0.01}, start));
  check(*plain);
  const Grid small = unit_grid(11, 40);
  const Field nothing = Field::Zero(small.node_count(), 3);
  REQUIRE(plain->advance(changing(small, {}, {1, 0}, nothing, nothing), exactly(1),
                         {nothing, nothing}));
  check(*plain);
}

TEST_CASE("exact frames one after another have the bits of each alone", "[plate][exact]") {
  const Outline outline = GENERATE(Outline(unit_grid(40, 23)), corner_shape(14, 12));
  const int nodes = outline.grid().node_count();
  const Field push = 1e3 * Field::Random(nodes, 3), other = 1e3 * Field::Random(nodes, 3);
  const Field nothing = Field::Zero(nodes, 3);
  Field minus = push;  // what is equal to another load, with other bits
  minus.col(0).setConstant(-0.0);
  Field plus = push;
  plus.col(0).setZero();
  // Keyed, kept, gone, with a jump, and a component that rests in between.
  const std::vector<Field> loads = {nothing, push, other,   other, nothing, nothing, push,
                                    minus,   plus, nothing, plus,  minus,   other,   push};
  const auto solver = make_plate_solver();
  PlateState state{nothing, nothing};
  for (std::size_t k = 1; k < loads.size(); ++k) {
    CAPTURE(k);
    const Field& first = k == 9 ? push : loads[k - 1];
    const PlateProblem problem = changing(outline, {1.5, 1, 2}, {40, 20}, first, loads[k]);
    PlateState next = solver->advance(problem, exactly(1e-3), state).value();
    const PlateState alone = make_plate_solver()->advance(problem, exactly(1e-3), state).value();
    CHECK(have_the_same_bits(next.displacement, alone.displacement));
    CHECK(have_the_same_bits(next.velocity, alone.velocity));
    state = std::move(next);
    if (k == 8) state.displacement.col(0) = state.velocity.col(0) = nothing.col(0);
  }
}

TEST_CASE("exact steps keep within the memory they may have, and stop", "[plate][exact]") {
  const Outline outline = GENERATE(Outline(unit_grid(101, 101)), corner_shape(70, 70));
  const Field load = Field::Ones(outline.grid().node_count(), 3);
  const PlateProblem problem = changing(outline, {}, {1, 0}, load, load);
  const PlateState state{0 * load, 0 * load};
  MemoryBudget small(std::size_t{1} << 20);
  const auto refused = make_plate_solver(SolverChoice::Auto, {.memory = &small})
                           ->advance(problem, exactly(1), state);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::OutOfMemory);
  CHECK(small.available() == small.total());
  int left = 2;
  const auto stopped =
      make_plate_solver(SolverChoice::Auto, {.should_stop = [&] { return left-- == 0; }})
          ->advance(problem, exactly(1), state);
  REQUIRE_FALSE(stopped);
  CHECK(stopped.error().code == ErrorCode::Interrupted);
}

TEST_CASE("the poles and residues are those of the Pade quotient", "[plate][exact]") {
  // R(z) e^(-z) = 1 + O(z^16), and G(z) = O(z^8).
  const auto value = [](double x, const Complex Pole::*residue, double sum) {
    for (const Pole& pole : poles) {
      const Complex part = pole.*residue * reciprocal(Complex{x, 0} - pole.place);
      sum += 2 * part.re;
    }
    return sum;
  };
  for (const double x : {-0.5, -0.1, 0.0, 0.1, 0.5}) {
    CHECK(value(x, &Pole::residue, 0) == Approx(std::exp(x)).epsilon(1e-11));
    CHECK(std::abs(value(x, &Pole::doubt, doubt_at_infinity)) < 1e-9);
  }
  CHECK(value(-4, &Pole::residue, 0) == Approx(std::exp(-4)).epsilon(1e-7));
  CHECK(std::abs(value(-1e9, &Pole::residue, 0)) < 1e-6);
}
