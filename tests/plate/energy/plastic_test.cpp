#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "pliant/plate/energy/plate_energy.hpp"
#include "pliant/plate/kernels/kernels.hpp"
#include "pliant/plate/plate_solver.hpp"
#include "support/catch.hpp"
#include "support/plates.hpp"
#include "support/sanitized.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

constexpr Edge clamped = Edge::Clamped, pinned = Edge::Pinned, free_edge = Edge::Free;

// The plate once more: dense matrices that make curvatures of displacements, written from the
// definitions, and a plain fixed point on a dense factor.
class DensePlate {
 public:
  explicit DensePlate(const PlateProblem& problem) : problem_(problem) {
    const Grid& grid = problem.outline.grid();
    const Edges& edges = problem.outline.edges();
    const int count = grid.node_count();
    b_ = Eigen::MatrixXd::Zero(3 * count, count);
    c_ = Eigen::MatrixXd::Zero(3 * count, 3 * count);
    area_ = Eigen::VectorXd::Ones(count);
    constant_ = Field::Zero(3 * count, 3);
    for (int j = 0; j < grid.rows; ++j) {
      for (int i = 0; i < grid.columns; ++i) {
        const int node = grid.node(i, j);
        const EdgeTangents& t = problem.tangents;
        const bool has_u = line(3 * node, grid.hu, i, grid.columns, edges.u0, edges.u1, t.su0,
                                t.su1, [&](int to) { return grid.node(to, j); });
        const bool has_v = line(3 * node + 1, grid.hv, j, grid.rows, edges.v0, edges.v1, t.sv0,
                                t.sv1, [&](int to) { return grid.node(i, to); });
        area_[node] =
            (i % (grid.columns - 1) == 0 ? 0.5 : 1) * (j % (grid.rows - 1) == 0 ? 0.5 : 1);
        int cells = 0;
        for (int q = std::max(0, j - 1); q <= std::min(grid.rows - 2, j); ++q) {
          for (int p = std::max(0, i - 1); p <= std::min(grid.columns - 2, i); ++p) ++cells;
        }
        for (int q = std::max(0, j - 1); q <= std::min(grid.rows - 2, j); ++q) {
          for (int p = std::max(0, i - 1); p <= std::min(grid.columns - 2, i); ++p) {
            const double unit = 1 / (grid.hu * grid.hv * cells);
            b_(3 * node + 2, grid.node(p, q)) += unit;
            b_(3 * node + 2, grid.node(p + 1, q)) -= unit;
            b_(3 * node + 2, grid.node(p, q + 1)) -= unit;
            b_(3 * node + 2, grid.node(p + 1, q + 1)) += unit;
          }
        }
        const auto& [b, c, d] = problem.stiffness;
        const double gamma = problem.poisson * std::sqrt(b * d);
        const double left = 1 - problem.poisson * problem.poisson;
        if (has_u) c_(3 * node, 3 * node) = has_v ? b : left * b;
        if (has_v) c_(3 * node + 1, 3 * node + 1) = has_u ? d : left * d;
        if (has_u && has_v) c_(3 * node, 3 * node + 1) = c_(3 * node + 1, 3 * node) = gamma;
        c_(3 * node + 2, 3 * node + 2) = c - 2 * gamma;
      }
    }
    const PlateSystem system = problem.system(1);
    stiffness_ = Eigen::MatrixXd::Zero(count, count);
    PlateEnergy(system).hessian<double>().for_each([&](int node, int other, double entry) {
      stiffness_(node, other) += entry;
      if (node != other) stiffness_(other, node) += entry;
    });
    numbers_ = numbers_of_unknowns(problem.outline);
  }

  // One step of backward Euler, all of displacement, velocity and plastic curvatures.
  void step(PlateState& state, double dt) const {
    const auto count = static_cast<Eigen::Index>(numbers_.size());
    const double shift = problem_.dynamics.shift(dt), inertia = problem_.dynamics.inertia(dt);
    Eigen::MatrixXd matrix = stiffness_;
    Field known = area_.asDiagonal() *
                  (problem_.load + shift * state.displacement + inertia * state.velocity);
    Eigen::VectorXd weights(3 * count);
    for (Eigen::Index k = 0; k < 3 * count; ++k) weights[k] = area_[k / 3];
    known -= b_.transpose() * weights.asDiagonal() * (c_ * constant_);
    matrix.diagonal() += shift * area_;
    for (Eigen::Index k = 0; k < count; ++k) {
      if (numbers_[k] >= 0) continue;
      known -= matrix.col(k) * state.displacement.row(k);
    }
    for (Eigen::Index k = 0; k < count; ++k) {
      if (numbers_[k] >= 0) continue;
      matrix.row(k).setZero();
      matrix.col(k).setZero();
      matrix(k, k) = 1;
    }
    const Eigen::LDLT<Eigen::MatrixXd> factor(matrix);
    Field w = state.displacement;
    PlasticField plastic;
    for (int round = 0; round < 4000; ++round) {
      plastic = flow(w, state.plastic);
      Field forces = known + b_.transpose() * weights.asDiagonal() * (c_ * stacked(plastic));
      for (Eigen::Index k = 0; k < count; ++k) {
        if (numbers_[k] < 0) forces.row(k) = state.displacement.row(k);
      }
      const Field next = factor.solve(forces);
      const double change = (next - w).cwiseAbs().maxCoeff();
      w = next;
      if (change < 1e-14 * w.cwiseAbs().maxCoeff()) break;
    }
    state.plastic = flow(w, state.plastic);
    state.velocity = (w - state.displacement) / dt;
    state.displacement = w;
  }

  double energy(const PlateState& state) const {
    const auto count = static_cast<Eigen::Index>(numbers_.size());
    const Field kappa = b_ * state.displacement, plastic = stacked(state.plastic);
    double sum = 0.5 * state.displacement.cwiseProduct(stiffness_ * state.displacement).sum();
    for (Eigen::Index k = 0; k < count; ++k) {
      const Eigen::Matrix3d block = c_.block<3, 3>(3 * k, 3 * k);
      const auto norm = [&](const Eigen::Matrix3d& x) { return x.cwiseProduct(block * x).sum(); };
      const Eigen::Matrix3d of_w = kappa.middleRows<3>(3 * k), of_p = plastic.middleRows<3>(3 * k);
      sum += area_[k] / 2 * (norm(of_w - of_p) - norm(of_w) + problem_.law->hardening * norm(of_p));
      sum += area_[k] / 2 * problem_.dynamics.density * state.velocity.row(k).squaredNorm();
    }
    return sum;
  }

 private:
  template <class Node>
  bool line(int row, double h, int i, int count, Edge first, Edge last, const Vector3d& s0,
            const Vector3d& s1, const Node& node) {
    const double unit = 1 / (h * h);
    if (i > 0 && i < count - 1) {
      b_(row, node(i - 1)) = b_(row, node(i + 1)) = unit;
      b_(row, node(i)) = -2 * unit;
      return true;
    }
    if ((i == 0 ? first : last) != clamped) return false;
    b_(row, node(i == 0 ? 1 : count - 2)) = 2 * unit;
    b_(row, node(i)) = -2 * unit;
    constant_.row(row) = (i == 0 ? -2 / h * s0 : Vector3d(2 / h * s1)).transpose();
    return true;
  }

  static Field stacked(const PlasticField& plastic) {
    Field all(3 * plastic.rows(), 3);
    for (Eigen::Index k = 0; k < plastic.rows(); ++k) {
      for (int n = 0; n < 9; ++n) all(3 * k + n / 3, n % 3) = plastic(k, n);
    }
    return all;
  }

  PlasticField flow(const Field& w, const PlasticField& from) const {
    const Field kappa = b_ * w + constant_, before = stacked(from);
    PlasticField to = from;
    const auto& [yield, hardening] = *problem_.law;
    for (Eigen::Index k = 0; k < from.rows(); ++k) {
      const Eigen::Matrix3d block = c_.block<3, 3>(3 * k, 3 * k);
      Eigen::Matrix3d xi =
          kappa.middleRows<3>(3 * k) - (1 + hardening) * before.middleRows<3>(3 * k);
      for (int n = 0; n < 3; ++n) {
        if (block(n, n) == 0) xi.row(n).setZero();
      }
      const double q = std::sqrt(xi.cwiseProduct(block * xi).sum());
      if (!(q > yield)) continue;
      for (int n = 0; n < 9; ++n) {
        to(k, n) += (q - yield) / (1 + hardening) / q * xi(n / 3, n % 3);
      }
    }
    return to;
  }

  const PlateProblem& problem_;
  Eigen::MatrixXd b_, c_, stiffness_;
  Eigen::VectorXd area_;
  Field constant_;
  std::vector<int> numbers_;
};

struct Case {
  std::string name;
  Edges edges;
  SolverChoice choice;
};
std::vector<Case> cases() {
  const SolverChoice factor = available_solvers().front();
  return {{"clamped in sine space", {}, SolverChoice::Spectral},
          {"clamped by a factor", {}, factor},
          {"hinged in sine space", {pinned, pinned, clamped, pinned}, SolverChoice::Spectral},
          {"free", {free_edge, free_edge, free_edge, free_edge}, factor},
          {"flag", {pinned, free_edge, clamped, free_edge}, factor}};
}

PlateProblem problem_of(const Case& one, const PlasticLaw& law) {
  const Grid grid = unit_grid(11, 9);
  PlateProblem problem{{grid, one.edges}, {1.5, 1.5, 2}, {0.002, 0.01}, {}, {}, 0.25};
  problem.load = with_interior(problem.outline, Field::Zero(grid.node_count(), 3),
                               20 * Field::Random(problem.outline.unknown_count(), 3));
  problem.load.col(1).array() += 20;
  if (one.edges.u0 == clamped) problem.tangents.su0 = {0.02, -0.1, 0.05};
  problem.law = law;
  return problem;
}

PlateState at_rest(const PlateProblem& problem) {
  const int count = problem.outline.grid().node_count();
  return {Field::Zero(count, 3), Field::Zero(count, 3), PlasticField::Zero(count, 9)};
}

}  // namespace

TEST_CASE("a plate that yields moves as the dense fixed point", "[plate][plastic]") {
  for (const Case& one : cases()) {
    for (const double hardening : {0.1, 0.02, 3.0}) {
      if (is_sanitized && hardening < 1) continue;  // the dense fixed point needs longest
      CAPTURE(one.name, hardening);
      PlateProblem problem = problem_of(one, {0.15, hardening});
      const DensePlate dense(problem);
      const auto solver = make_plate_solver(one.choice);
      PlateState state = at_rest(problem), expected = state;
      const double dt = 0.01;
      for (int frame = 0; frame < (is_sanitized ? 1 : 3); ++frame) {
        if (frame == 2) problem.load *= -0.7;
        INFO("solves so far: " << solver->counts().solves);
        auto next = solver->advance(problem, {3, dt}, state);
        REQUIRE(next.has_value());
        state = *std::move(next);
        for (int step = 0; step < 3; ++step) dense.step(expected, dt);
        const double peak = expected.displacement.cwiseAbs().maxCoeff();
        CHECK(expected.plastic.cwiseAbs().maxCoeff() > 0.01);
        CHECK((state.displacement - expected.displacement).cwiseAbs().maxCoeff() < 1e-8 * peak);
        CHECK((state.plastic - expected.plastic).cwiseAbs().maxCoeff() <
              1e-6 * expected.plastic.cwiseAbs().maxCoeff());
      }
    }
  }
}

// On a single line of nodes, forces of what is held may cancel while it makes its rim flow.
TEST_CASE("a narrow plate flows by what is held alone", "[plate][plastic]") {
  struct Narrow {
    int columns, rows;
    bool is_bent_by_its_rim;
  };
  for (const Narrow& one : {Narrow{3, 9, false}, Narrow{9, 3, false}, Narrow{3, 3, false},
                            Narrow{3, 9, true}, Narrow{9, 3, true}}) {
    for (const bool is_pushed : {false, true}) {
      if (is_sanitized && !is_pushed) continue;
      CAPTURE(one.columns, one.rows, one.is_bent_by_its_rim, is_pushed);
      const Grid grid = unit_grid(one.columns, one.rows);
      PlateProblem problem{{grid}, {1, 1, 2}, {0.02, 0.05}, {}, Field::Zero(grid.node_count(), 3)};
      problem.law = PlasticLaw{0.5, 0.2};
      PlateState state = at_rest(problem);
      const bool is_along_u = one.columns == 3;
      if (one.is_bent_by_its_rim) {
        for (int j = 0; j < grid.rows; ++j) {
          for (int i = 0; i < grid.columns; ++i) {
            const int across = is_along_u ? i : j;
            state.displacement.row(grid.node(i, j)) =
                (across - 1) * Eigen::RowVector3d(0.2, 0.1, 0);
          }
        }
      } else if (is_along_u) {
        problem.tangents.su0 = problem.tangents.su1 = {2, 0, -1};
      } else {
        problem.tangents.sv0 = problem.tangents.sv1 = {2, 0, -1};
      }
      if (is_pushed) problem.load.col(1).array() += 200;
      const DensePlate dense(problem);
      const auto solver = make_plate_solver();
      PlateState expected = state;
      for (int frame = 0; frame < (is_sanitized ? 1 : 3); ++frame) {
        auto next = solver->advance(problem, {2, 0.02}, state);
        REQUIRE(next.has_value());
        state = *std::move(next);
        for (int step = 0; step < 2; ++step) dense.step(expected, 0.02);
        CHECK(expected.plastic.cwiseAbs().maxCoeff() > 0.01);
        CHECK((state.displacement - expected.displacement).cwiseAbs().maxCoeff() <
              1e-8 * expected.displacement.cwiseAbs().maxCoeff() + 1e-12);
        CHECK((state.plastic - expected.plastic).cwiseAbs().maxCoeff() <
              1e-6 * expected.plastic.cwiseAbs().maxCoeff());
      }
    }
  }
}

TEST_CASE("a plate that yields nowhere has the elastic bits", "[plate][plastic]") {
  for (const Case& one : cases()) {
    for (const Integrator integrator : {Integrator::BackwardEuler, Integrator::Newmark}) {
      CAPTURE(one.name);
      PlateProblem problem = problem_of(one, {1e6, 0.1});
      const auto solver = make_plate_solver(one.choice);
      const TimeSteps steps{4, 0.01, integrator};
      const auto plastic = solver->advance(problem, steps, at_rest(problem));
      problem.law.reset();
      const auto elastic = solver->advance(problem, steps, at_rest(problem));
      REQUIRE((plastic && elastic));
      CHECK(plastic->displacement == elastic->displacement);
      CHECK(plastic->velocity == elastic->velocity);
      CHECK(plastic->plastic.isZero(0));
    }
  }
}

TEST_CASE("energy never grows while a plate flows", "[plate][plastic]") {
  for (const Case& one : cases()) {
    for (const Integrator integrator : {Integrator::BackwardEuler, Integrator::Newmark}) {
      CAPTURE(one.name, static_cast<int>(integrator));
      PlateProblem problem = problem_of(one, {0.15, 0.1});
      problem.dynamics.damping = 0;
      problem.tangents = {};
      const DensePlate dense(problem);
      const auto solver = make_plate_solver(one.choice);
      PlateState state = *solver->advance(problem, {3, 0.01}, at_rest(problem));
      problem.load.setZero();
      state.velocity *= 3;
      double before = dense.energy(state);
      const double first = before;
      for (int frame = 0; frame < (is_sanitized ? 4 : 40); ++frame) {
        auto next = solver->advance(problem, {1, 0.013, integrator}, state);
        if (!next) FAIL(next.error().message);
        state = *std::move(next);
        const double now = dense.energy(state);
        CHECK(now <= before + 1e-8 * first);
        before = now;
      }
      CHECK(before < first);
    }
  }
}

TEST_CASE("what a step learns ends with its frame", "[plate][plastic]") {
  for (const Case& one : cases()) {
    for (const Integrator integrator : {Integrator::BackwardEuler, Integrator::Newmark}) {
      CAPTURE(one.name);
      PlateProblem problem = problem_of(one, {0.15, 0.1});
      const TimeSteps steps{3, 0.01, integrator};
      const auto solver = make_plate_solver(one.choice);
      PlateState state = at_rest(problem), other = state;
      for (int frame = 0; frame < 3; ++frame) {
        state = *solver->advance(problem, steps, state);
        other = *make_plate_solver(one.choice)->advance(problem, steps, other);
        problem.load *= frame == 0 ? 1.2 : -0.5;
      }
      CHECK(state.plastic.cwiseAbs().maxCoeff() > 0.01);
      CHECK(state.displacement == other.displacement);
      CHECK(state.velocity == other.velocity);
      CHECK(state.plastic == other.plastic);
    }
  }
}

TEST_CASE("a plate that flows has the same bits with vectors of every width", "[plate][plastic]") {
  for (const Case& one : cases()) {
    for (const int components : {1, 2, 3}) {
      CAPTURE(one.name, components);
      PlateProblem problem = problem_of(one, {0.15, 0.1});
      problem.tangents = {};
      problem.load *= 2;  // a free plate may else not yield by one component alone
      for (int k = 2; k >= components; --k) problem.load.col(k == 2 ? 0 : 2).setZero();
      const auto run = [&](int lanes) {
        const auto solver = make_plate_solver(one.choice, {.most_lanes = lanes});
        PlateState state = at_rest(problem);
        for (int frame = 0; frame < 2; ++frame)
          state = *solver->advance(problem, {3, 0.01}, std::move(state));
        return state;
      };
      const PlateState widest = run(widest_lanes);
      CHECK(widest.plastic.cwiseAbs().maxCoeff() > 0.01);
      for (int which = 0; runnable_kernels(which); ++which) {
        const PlateState state = run(runnable_kernels(which)->lanes);
        CAPTURE(runnable_kernels(which)->name);
        CHECK(state.displacement == widest.displacement);
        CHECK(state.velocity == widest.velocity);
        CHECK(state.plastic == widest.plastic);
      }
    }
  }
}

// One component alone is another code path than three.
TEST_CASE("a plate that is pushed along an axis flows as one that is pushed askew",
          "[plate][plastic]") {
  PlateProblem along = problem_of(cases()[0], {0.15, 0.1});
  along.tangents = {};
  along.load.col(0).setZero();
  along.load.col(2).setZero();
  PlateProblem askew = along;
  const Vector3d way(2.0 / 3, 1.0 / 3, -2.0 / 3);
  askew.load = along.load.col(1) * way.transpose();
  const auto solver = make_plate_solver();
  PlateState state = at_rest(along), other = state;
  for (int frame = 0; frame < 3; ++frame) {
    state = *solver->advance(along, {3, 0.01}, state);
    other = *solver->advance(askew, {3, 0.01}, other);
    along.load *= -0.8;
    askew.load *= -0.8;
  }
  const double peak = state.displacement.cwiseAbs().maxCoeff();
  CHECK(state.plastic.cwiseAbs().maxCoeff() > 0.01);
  CHECK(state.displacement.col(0).isZero(0));
  const Field turned = state.displacement.col(1) * way.transpose();
  CHECK((other.displacement - turned).cwiseAbs().maxCoeff() < 2e-9 * peak);
}

// A strip between two hinges is statically determinate: its moment is that of the load alone,
// M_i = q x (1 - x)/2, and flows where it is over the yield stress.
TEST_CASE("a strip between two hinges bends as in closed form, and back", "[plate][plastic]") {
  const int columns = 21;
  const Grid grid = unit_grid(columns, 4);
  const double h = grid.hu, yield = 0.5, hardening = 0.2;
  const Outline outline(grid, {pinned, pinned, free_edge, free_edge});
  PlateProblem problem{outline, {1, 2, 1}, {0, 0}, {}, {}, 0};
  problem.law = PlasticLaw{yield, hardening};
  const auto solver = make_plate_solver();
  PlateState state = at_rest(problem);
  std::vector<double> flowed(columns, 0.0);
  const auto expect = [&](double q) {
    // Kinematic hardening: the stress M - H k_p stays within the yield stress.
    std::vector<double> bent(columns, 0.0);
    for (int i = 1; i < columns - 1; ++i) {
      const double x = i * h, moment = -q * x * (1 - x) / 2;
      const double stress = moment - hardening * flowed[i];
      if (std::abs(stress) > yield) {
        flowed[i] += (stress - std::copysign(yield, stress)) / hardening;
      }
      bent[i] = moment + flowed[i];
    }
    // w'' = bent between zeros: the sum of two sums.
    std::vector<double> w(columns, 0.0);
    double slope = 0;
    for (int i = 1; i < columns; ++i) {
      w[i] = w[i - 1] + slope * h;
      slope += bent[i] * h;
    }
    const double end = w[columns - 1];
    for (int i = 0; i < columns; ++i) w[i] -= end * i / (columns - 1);
    return w;
  };
  for (const double q : {2.0, 6.0, 9.0, 0.0, -3.0, -9.0, 0.0, 9.0, 0.0}) {
    CAPTURE(q);
    problem.load = Field::Zero(grid.node_count(), 3);
    problem.load.col(1).setConstant(q);
    auto next = solver->advance(problem, {1, 1}, state);
    REQUIRE(next.has_value());
    state = *std::move(next);
    const std::vector<double> w = expect(q);
    for (int j = 0; j < grid.rows; ++j) {
      for (int i = 0; i < columns; ++i) {
        CHECK_THAT(state.displacement(grid.node(i, j), 1), WithinAbs(w[i], 1e-8));
      }
    }
  }
}
