#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/LU>

#include "pliant/plate/plate_solver.hpp"
#include "support/catch.hpp"
#include "support/plates.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

// In sine space, by factors, and on a mask.
struct Case {
  std::string name;
  SolverChoice choice;
  Outline outline;
};

Outline l_shape(int side) {
  const Grid grid = unit_grid(side, side);
  InteriorMask mask(static_cast<std::size_t>(grid.node_count()));
  for (int j = 1; j + 1 < side; ++j) {
    for (int i = 1; i + 1 < side; ++i) {
      mask[grid.node(i, j)] = i < side / 2 || j < side / 2;
    }
  }
  return {grid, mask};
}

std::vector<Case> cases() {
  return {{"sine space", SolverChoice::Spectral, unit_grid(12, 9)},
          {"factor", available_solvers().front(), unit_grid(12, 9)},
          {"mask", SolverChoice::Auto, l_shape(24)}};
}

}  // namespace

TEST_CASE("Newmark's steps keep the energy of an undamped plate", "[plate][newmark]") {
  for (const Case& one : cases()) {
    const Outline& outline = one.outline;
    CAPTURE(one.name);
    const double density = 2;
    const Eigen::MatrixXd L = dense_operator({outline, {1.5, 0.5, 2}, 0});
    const auto n = L.rows();
    const Field load = with_interior(outline, Field::Zero(outline.grid().node_count(), 3),
                                     1e3 * Field::Random(n, 3));
    PlateState state{Field::Zero(load.rows(), 3), Field::Zero(load.rows(), 3)};
    state.velocity = with_interior(outline, state.velocity, Field::Random(n, 3));
    double largest = 0;
    const auto energy = [&] {
      const Field w = interior_of(outline, state.displacement);
      const Field v = interior_of(outline, state.velocity);
      const double moving = density / 2 * v.squaredNorm();
      const double bent = w.cwiseProduct(L * w).sum() / 2;
      largest = std::max(largest, moving + bent);
      return moving + bent - w.cwiseProduct(interior_of(outline, load)).sum();
    };
    const double first = energy();
    const auto solver = make_plate_solver(one.choice);
    const PlateProblem problem{outline, {1.5, 0.5, 2}, {density, 0}, {}, load};
    double worst = 0;
    const int intervals = one.name == "rectangles" ? 20 : 500;
    for (int interval = 0; interval < intervals; ++interval) {
      state = solver->advance(problem, {20, 0.003, Integrator::Newmark}, std::move(state)).value();
      worst = std::max(worst, std::abs(energy() - first));
    }
    CHECK(worst < 1e-10 * largest);
    // What the bound is worth: backward Euler takes the energy away.
    state = solver->advance(problem, {20, 0.003}, std::move(state)).value();
    CHECK(std::abs(energy() - first) > 1e-3 * largest);
  }
}

TEST_CASE("Newmark's steps are those of the trapezoidal rule", "[plate][newmark]") {
  for (const auto& [name, choice, outline] : cases()) {
    CAPTURE(name);
    const Stiffness stiffness{1.5, 0.5, 2};
    const Dynamics dynamics{3, 7};
    const double dt = 2e-3;
    const Eigen::MatrixXd L = dense_operator({outline, stiffness, 0});
    const auto n = L.rows();
    const auto nodes = outline.grid().node_count();
    EdgeTangents tangents;
    if (outline.is_rectangle()) tangents.su0 = {1, -2, 0.5};
    const Field load = 1e3 * Field::Random(nodes, 3);
    PlateState state{Field::Random(nodes, 3), Field::Random(nodes, 3)};

    // x' = A x + g with x = (w, v).
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    A.topRightCorner(n, n).setIdentity();
    A.bottomLeftCorner(n, n) = -L / dynamics.density;
    A.bottomRightCorner(n, n).diagonal().setConstant(-dynamics.damping / dynamics.density);
    const Field still = with_interior(outline, state.displacement, Field::Zero(n, 3));
    Eigen::MatrixXd g = Eigen::MatrixXd::Zero(2 * n, 3);
    g.bottomRows(n) =
        (interior_of(outline, load) - apply_stencil(outline, stiffness, tangents, still)) /
        dynamics.density;
    Eigen::MatrixXd x(2 * n, 3);
    x << interior_of(outline, state.displacement), interior_of(outline, state.velocity);
    const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(2 * n, 2 * n);
    const auto lu = (one - dt / 2 * A).partialPivLu();
    for (int step = 0; step < 11; ++step) {
      x = lu.solve((one + dt / 2 * A) * x + dt * g).eval();
    }

    const auto solver = make_plate_solver(choice);
    const PlateProblem problem{outline, stiffness, dynamics, tangents, load};
    const PlateState before = state;
    state = solver->advance(problem, {11, dt, Integrator::Newmark}, std::move(state)).value();
    const auto differs = [](const Field& a, const Eigen::MatrixXd& b) {
      return (a - b).norm() / b.norm();
    };
    CHECK(differs(interior_of(outline, state.displacement), x.topRows(n)) < 1e-10);
    CHECK(differs(interior_of(outline, state.velocity), x.bottomRows(n)) < 1e-9);
    CHECK(with_interior(outline, state.displacement, Field::Zero(n, 3)) == still);
    CHECK(with_interior(outline, state.velocity, Field::Zero(n, 3)).isZero(0));
  }
}
