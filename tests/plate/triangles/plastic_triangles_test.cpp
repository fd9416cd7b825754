#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "pliant/plate/plate_solver.hpp"
#include "pliant/plate/triangles/triangle_plate.hpp"
#include "pliant/region/triangles/triangle_cut.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/plates.hpp"
#include "support/sanitized.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

std::vector<bool> at_border(const TriangleSurface& surface) {
  std::vector<bool> is_border(static_cast<std::size_t>(surface.node_count()));
  for (int face = 0; face < surface.face_count(); ++face) {
    const std::span<const int> nodes = surface.nodes_of(face), edges = surface.edges_of(face);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      if (surface.edge_sides[edges[k]] != 1) continue;
      is_border[nodes[k]] = is_border[nodes[(k + 1) % nodes.size()]] = true;
    }
  }
  return is_border;
}

// The part of a mesh nearer to the origin than `radius`.
TrianglePatch patch_of(const Mesh& mesh, double radius, Border border) {
  const TriangleSurface surface = make_surface(mesh, {.unit = std::array{1.0, 1.0}}).value();
  const SampledForce force{PointForce{{0.02, 0, 0.01}, {0, 1, 0}}, 1, radius, radius,
                           Falloff::Constant};
  LevelSet level_set = find_level_set(surface, PointTree(surface.rest), {}, std::array{force}, {});
  snap(level_set);
  return cut_out(surface, level_set, at_border(surface), border)->at(0);
}

struct Case {
  std::string name;
  TrianglePatch patch;
};

std::vector<Case> cases() {
  return {{"whole, clamped", patch_of(square(6, 1, 0.3), 9, Border::Clamped)},
          {"whole, free", patch_of(square(5, 1, 0.3), 9, Border::Free)},
          {"quads, pinned", patch_of(square(5, 1, 0.3, true), 9, Border::Pinned)},
          {"cut out of triangles", patch_of(square(8, 1, 0.3), 0.42, Border::Clamped)},
          {"cut out of quads", patch_of(square(7, 1, 0.3, true), 0.42, Border::Clamped)},
          {"a corner, free", patch_of(square(7, 1, 0.3, true), 0.6, Border::Free)}};
}

std::shared_ptr<const CellFactors> uneven(const TriangleCells& cells) {
  CellFactors factors;
  const std::vector<int> triangles = triangles_of(cells);
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    factors.yield.push_back(0.8 + 0.05 * static_cast<double>(k % 7));
    factors.hardening.push_back(1.1 - 0.1 * static_cast<double>(k % 5));
  }
  for (const TriangleCell& cell : cells.cells) {
    factors.b.push_back(1 + 0.1 * (cell.triangle % 3));
    factors.c.push_back(1 + 0.05 * (cell.triangle % 4));
    factors.d.push_back(1.2 - 0.1 * (cell.triangle % 2));
  }
  return std::make_shared<const CellFactors>(factors);
}

TriangleProblem problem_of(const TrianglePatch& patch, double hardening) {
  TriangleProblem problem;
  problem.bending = bending_of({1.5, 2.5, 2}, {1, 1}, 0.25);
  problem.dynamics = {0.002, 0.01};
  problem.tangents = {Vector3d(0.02, -0.1, 0.05), Vector3d(-0.03, 0.05, 0), Vector3d(0, 0.06, 0),
                      Vector3d(0.01, 0.02, -0.04)};
  const Eigen::Map<const Eigen::VectorXd> masses(patch.masses.data(),
                                                 static_cast<Eigen::Index>(patch.masses.size()));
  Field even = 20 * Field::Random(masses.size(), 3);
  even.col(1).array() += 30;
  problem.load = masses.asDiagonal() * even;
  problem.law = PlasticLaw{0.15, hardening};
  return problem;
}

PlateState at_rest(const TriangleCells& cells, Eigen::Index masses) {
  Field displacement = Field::Zero(cells.point_count, 3);
  for (int k = cells.free_points; k < cells.point_count; ++k)
    displacement.row(k) << 0.001 * (k % 3), -0.001 * (k % 2), 0.0005 * (k % 5);
  const auto triangles = static_cast<Eigen::Index>(triangles_of(cells).size());
  return {displacement, Field::Zero(masses, 3), PlasticField::Zero(triangles, 9)};
}

double largest(const Eigen::Ref<const Eigen::MatrixXd>& numbers) {
  return numbers.cwiseAbs().maxCoeff();
}

// The plate once more: dense matrices on all unknowns, written from the equations of cells and
// triangles, and a plain fixed point on a dense factor.
class DenseTriangles {
 public:
  DenseTriangles(const TrianglePlate& plate, const TriangleProblem& problem)
      : plate_(plate), problem_(problem) {
    const TriangleCells& cells = plate.cells();
    triangles_ = plate.triangles();
    const auto size = static_cast<Eigen::Index>(cells.unknown_count());
    const auto count = static_cast<Eigen::Index>(triangles_.size());
    b_ = Eigen::MatrixXd::Zero(3 * count, size);
    held_ = Field::Zero(3 * count, 3);
    areas_ = Eigen::VectorXd::Zero(count);
    c_ = Eigen::MatrixXd::Zero(3 * count, 3);
    stiffness_ = Eigen::MatrixXd::Zero(size, size);
    known_ = Field::Zero(size, 3);
  }

  // Requires: once, before all else. For steps of `dt`.
  void assemble(const Field& displacement, double dt) {
    dt_ = dt;
    const TriangleCells& cells = plate_.cells();
    std::vector<std::pair<Eigen::MatrixXd, Eigen::Matrix3d>> rows;
    for (const TriangleCell& cell : cells.cells) {
      rows.push_back(curvature_of(cell, displacement));
      areas_[place(cell.triangle)] += std::abs(cell.shape.signed_area());
    }
    for (std::size_t k = 0; k < cells.cells.size(); ++k) {
      const TriangleCell& cell = cells.cells[k];
      const Eigen::Index at = place(cell.triangle);
      const double area = std::abs(cell.shape.signed_area());
      const Eigen::Matrix3d form = form_of(static_cast<int>(k));
      stiffness_ += area * rows[k].first.transpose() * form * rows[k].first;
      known_ -= area * rows[k].first.transpose() * form * rows[k].second;
      b_.middleRows<3>(3 * at) += area / areas_[at] * rows[k].first;
      held_.middleRows<3>(3 * at) += area / areas_[at] * rows[k].second;
      c_.middleRows<3>(3 * at) = form;
    }
    Eigen::MatrixXd matrix = stiffness_;
    for (std::size_t k = 0; k < plate_.masses().size(); ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      matrix(at, at) += problem_.dynamics.shift(dt) * plate_.masses()[k];
    }
    factor_.compute(matrix);
    by_moments_ = b_ * factor_.solve(Eigen::MatrixXd(b_.transpose()));
  }

  // One step of backward Euler, all of displacement, velocity and plastic curvatures.
  void step(PlateState& state) const {
    const auto points = static_cast<Eigen::Index>(plate_.masses().size());
    const Eigen::Map<const Eigen::VectorXd> masses(plate_.masses().data(), points);
    const double shift = problem_.dynamics.shift(dt_), inertia = problem_.dynamics.inertia(dt_);
    const Field w = state.displacement.topRows(points);
    Field known = known_;
    known.topRows(points) +=
        problem_.load + masses.asDiagonal() * (shift * w + inertia * state.velocity);
    const Field elastic = b_ * factor_.solve(known) + held_;
    Field kappa = elastic, moments;
    for (int round = 0; round < 4000; ++round) {
      moments = moments_of(flow(kappa, state.plastic));
      const Field next = elastic + by_moments_ * moments;
      const double change = largest(next - kappa);
      kappa = next;
      if (change < 1e-13 * largest(kappa)) break;
    }
    const Field x = factor_.solve(known + b_.transpose() * moments);
    state.plastic = flow(kappa, state.plastic);
    state.velocity = (x.topRows(points) - w) / dt_;
    state.displacement.topRows(points) = x.topRows(points);
  }

  // One step of Newmark's, twice as long.
  void reflect(PlateState& state) const {
    PlateState next = state;
    step(next);
    const auto points = static_cast<Eigen::Index>(plate_.masses().size());
    state.displacement.topRows(points) =
        2 * next.displacement.topRows(points) - Field(state.displacement.topRows(points));
    state.velocity = 2 * next.velocity - state.velocity;
    state.plastic = 2 * next.plastic - state.plastic;
  }

  // Of a plate at rest on its rim, without slopes: the least over all that has no mass.
  double energy(const PlateState& state) const {
    const auto points = static_cast<Eigen::Index>(plate_.masses().size());
    const auto others = stiffness_.rows() - points;
    const Eigen::Map<const Eigen::VectorXd> masses(plate_.masses().data(), points);
    const Field w = state.displacement.topRows(points),
                forces = b_.transpose() * moments_of(state.plastic);
    Field x(stiffness_.rows(), 3);
    x.topRows(points) = w;
    x.bottomRows(others) = stiffness_.bottomRightCorner(others, others)
                               .ldlt()
                               .solve(Field(forces.bottomRows(others) -
                                            stiffness_.bottomLeftCorner(others, points) * w));
    double sum = 0.5 * x.cwiseProduct(stiffness_ * x).sum() - x.cwiseProduct(forces).sum();
    for (Eigen::Index k = 0; k < areas_.size(); ++k) {
      const Eigen::Matrix3d plastic = stacked(state.plastic, k);
      const double norm = plastic.cwiseProduct(c_.middleRows<3>(3 * k) * plastic).sum();
      sum += areas_[k] / 2 * (1 + law(k).hardening) * norm;
    }
    for (int k = 0; k < 3; ++k)
      sum += 0.5 * problem_.dynamics.density * masses.dot(state.velocity.col(k).cwiseAbs2());
    return sum;
  }

 private:
  Eigen::Index place(int triangle) const {
    return std::find(triangles_.begin(), triangles_.end(), triangle) - triangles_.begin();
  }

  PlasticLaw law(Eigen::Index triangle) const {
    PlasticLaw law = *problem_.law;
    if (const CellFactors* factors = plate_.factors()) {
      law.yield *= factor_at(factors->yield, static_cast<int>(triangle));
      law.hardening *= factor_at(factors->hardening, static_cast<int>(triangle));
    }
    return law;
  }

  Eigen::Matrix3d form_of(int cell) const {
    const Bending form = bending_at(problem_.bending, plate_.factors(), cell);
    Eigen::Matrix3d matrix;
    matrix << form.uu, form.coupling, 0, form.coupling, form.vv, 0, 0, 0, form.uv;
    return matrix;
  }

  // H = 1/A sum l_k (theta_k - n_k . grad w) n_k n_k^T, by the unknowns and by what is held.
  std::pair<Eigen::MatrixXd, Eigen::Matrix3d> curvature_of(const TriangleCell& cell,
                                                           const Field& displacement) const {
    using Vector = Eigen::Vector2d;
    const TriangleCells& cells = plate_.cells();
    const Vector corners[] = {
        {0, 0}, {cell.shape.b[0], cell.shape.b[1]}, {cell.shape.c[0], cell.shape.c[1]}};
    Eigen::Matrix2d edges;
    edges << corners[1].transpose(), corners[2].transpose();
    const Eigen::Matrix2d inverse = edges.inverse();
    const Vector hats[] = {-inverse.col(0) - inverse.col(1), inverse.col(0), inverse.col(1)};
    const double area = std::abs(cell.shape.signed_area());
    Eigen::MatrixXd by(3, cells.unknown_count());
    by.setZero();
    Eigen::Matrix3d held = Eigen::Matrix3d::Zero();
    for (int k = 0; k < 3; ++k) {
      const Vector side = corners[(k + 1) % 3] - corners[k];
      Vector n(side[1], -side[0]);
      n.normalize();
      if (n.dot(corners[(k + 2) % 3] - corners[k]) > 0) n = -n;
      const Eigen::Vector3d tensor =
          side.norm() / area * Eigen::Vector3d(n[0] * n[0], n[1] * n[1], n[0] * n[1]);
      const SideSlope& slope = cell.slopes[k];
      for (int m = 0; m < slope.count; ++m)
        by.col(cells.free_points + slope.first + m) += slope.sign * tensor;
      if (slope.count == 0) {
        const auto& s = problem_.tangents;
        const Vector3d given = n[0] * n[0] * (n[0] > 0 ? s.su1 : Vector3d(-s.su0)) +
                               n[1] * n[1] * (n[1] > 0 ? s.sv1 : Vector3d(-s.sv0));
        held += tensor * given.transpose();
      }
      for (int corner = 0; corner < 3; ++corner) {
        const int point = cell.points[corner];
        if (point < cells.free_points) {
          by.col(point) -= n.dot(hats[corner]) * tensor;
        } else {
          held -= n.dot(hats[corner]) * tensor * displacement.row(point);
        }
      }
    }
    return {by, held};
  }

  static Eigen::Matrix3d stacked(const PlasticField& plastic, Eigen::Index k) {
    Eigen::Matrix3d all;
    for (int n = 0; n < 9; ++n) all(n / 3, n % 3) = plastic(k, n);
    return all;
  }

  Field moments_of(const PlasticField& plastic) const {
    Field moments(3 * areas_.size(), 3);
    for (Eigen::Index k = 0; k < areas_.size(); ++k) {
      moments.middleRows<3>(3 * k) = areas_[k] * c_.middleRows<3>(3 * k) * stacked(plastic, k);
    }
    return moments;
  }

  PlasticField flow(const Field& kappa, const PlasticField& from) const {
    PlasticField to = from;
    for (Eigen::Index k = 0; k < areas_.size(); ++k) {
      const auto [yield, hardening] = law(k);
      const Eigen::Matrix3d xi = kappa.middleRows<3>(3 * k) - (1 + hardening) * stacked(from, k);
      const double q = std::sqrt(xi.cwiseProduct(c_.middleRows<3>(3 * k) * xi).sum());
      if (!(q > yield)) continue;
      for (int n = 0; n < 9; ++n) to(k, n) += (q - yield) / (1 + hardening) / q * xi(n / 3, n % 3);
    }
    return to;
  }

  const TrianglePlate& plate_;
  const TriangleProblem& problem_;
  std::vector<int> triangles_;
  Eigen::MatrixXd b_, c_, stiffness_;
  Eigen::VectorXd areas_;
  Field held_, known_;
  double dt_ = 0;
  Eigen::LDLT<Eigen::MatrixXd> factor_;
  Eigen::MatrixXd by_moments_;  // the curvatures that moments on the triangles make
};

TrianglePlate plate_of(const TrianglePatch& patch,
                       std::shared_ptr<const CellFactors> factors = {}) {
  return {patch.cells, patch.masses, available_solvers().front(), {}, std::move(factors)};
}

}  // namespace

TEST_CASE("triangles that yield move as the dense fixed point", "[plate][plastic][morley]") {
  for (const Case& one : cases()) {
    for (const double hardening : {0.3, 3.0}) {
      for (const bool is_uneven : {false, true}) {
        // The dense fixed point needs longest; a sanitizer needs each path once.
        if (is_sanitized && (hardening < 1 || !is_uneven)) continue;
        if (is_uneven && hardening > 1) continue;
        for (const Integrator integrator : {Integrator::BackwardEuler, Integrator::Newmark}) {
          CAPTURE(one.name, hardening, is_uneven, static_cast<int>(integrator));
          TriangleProblem problem = problem_of(one.patch, hardening);
          TrianglePlate plate = plate_of(one.patch, is_uneven ? uneven(one.patch.cells) : nullptr);
          PlateState state = at_rest(one.patch.cells, problem.load.rows()), expected = state;
          DenseTriangles dense(plate, problem);
          const TimeSteps steps{2, 0.01, integrator};
          dense.assemble(state.displacement, steps.solved_length());
          for (int frame = 0; frame < (is_sanitized ? 1 : 3); ++frame) {
            if (frame == 2) problem.load *= -0.7;
            auto next = plate.advance(problem, steps, state);
            if (!next) FAIL(next.error().message);
            state = *std::move(next);
            for (int step = 0; step < 2; ++step) {
              if (integrator == Integrator::Newmark) {
                dense.reflect(expected);
              } else {
                dense.step(expected);
              }
            }
            const double peak = largest(expected.displacement);
            CHECK(largest(expected.plastic) > 0.01);
            CHECK(largest(state.displacement - expected.displacement) < 1e-8 * peak);
            CHECK(largest(state.plastic - expected.plastic) < 1e-6 * largest(expected.plastic));
          }
        }
      }
    }
  }
}

TEST_CASE("triangles that yield nowhere have the elastic bits", "[plate][plastic][morley]") {
  for (const Case& one : cases()) {
    for (const Integrator integrator : {Integrator::BackwardEuler, Integrator::Newmark}) {
      CAPTURE(one.name);
      TriangleProblem problem = problem_of(one.patch, 0.1);
      problem.law->yield = 1e6;
      const TimeSteps steps{4, 0.01, integrator};
      const PlateState start = at_rest(one.patch.cells, problem.load.rows());
      const auto plastic = plate_of(one.patch).advance(problem, steps, start);
      problem.law.reset();
      const auto elastic = plate_of(one.patch).advance(problem, steps, start);
      REQUIRE((plastic && elastic));
      CHECK(plastic->displacement == elastic->displacement);
      CHECK(plastic->velocity == elastic->velocity);
      CHECK(plastic->plastic.isZero(0));
    }
  }
}

TEST_CASE("energy never grows while triangles flow", "[plate][plastic][morley]") {
  std::vector<Case> all = cases();
  if (is_sanitized) all.resize(1, all.front());
  for (const Case& one : all) {
    for (const Integrator integrator : {Integrator::BackwardEuler, Integrator::Newmark}) {
      CAPTURE(one.name, static_cast<int>(integrator));
      TriangleProblem problem = problem_of(one.patch, 0.1);
      problem.dynamics.damping = 0;
      problem.tangents = {};
      TrianglePlate plate = plate_of(one.patch);
      PlateState state = at_rest(one.patch.cells, problem.load.rows());
      state.displacement.setZero();
      state = *plate.advance(problem, {3, 0.01}, state);
      problem.load.setZero();
      state.velocity *= 3;
      DenseTriangles dense(plate, problem);
      dense.assemble(state.displacement, 1);
      const double first = dense.energy(state);
      double before = first;
      for (int frame = 0; frame < (is_sanitized ? 4 : 30); ++frame) {
        auto next = plate.advance(problem, {1, 0.013, integrator}, state);
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

TEST_CASE("what steps of triangles learn ends with their frame", "[plate][plastic][morley]") {
  for (const Case& one : cases()) {
    CAPTURE(one.name);
    TriangleProblem problem = problem_of(one.patch, 0.1);
    TrianglePlate plate = plate_of(one.patch);
    PlateState state = at_rest(one.patch.cells, problem.load.rows()), other = state;
    for (int frame = 0; frame < 3; ++frame) {
      state = *plate.advance(problem, {3, 0.01}, state);
      other = *plate_of(one.patch).advance(problem, {3, 0.01}, other);
      problem.load *= frame == 0 ? 1.2 : -0.5;
    }
    CHECK(largest(state.plastic) > 0.01);
    CHECK(state.displacement == other.displacement);
    CHECK(state.plastic == other.plastic);
  }
}

TEST_CASE("the pairs of unknowns that are left are those of all blocks", "[plate][morley]") {
  for (const bool has_quads : {false, true}) {
    for (const Border border : {Border::Clamped, Border::Pinned, Border::Free}) {
      const TrianglePatch patch = patch_of(square(7, 1, 0.3, has_quads), 0.42, border);
      const ReducedUnknowns reduced(patch.cells, patch.free_nodes);
      std::size_t pairs = 0;
      CellBlock<double> block;
      for (int k = 0; k < patch.cells.block_count(); ++k) {
        block.compute(patch.cells, k, reduced, {});
        const auto left = static_cast<std::size_t>(block.size() - block.inner_count());
        pairs += left * (left + 1) / 2;
      }
      CHECK(reduced.pairs == pairs);
    }
  }
}

TEST_CASE("triangles flow alike in all directions", "[plate][plastic][morley]") {
  const TrianglePatch patch = patch_of(square(7, 1, 0.3, true), 0.42, Border::Clamped);
  Matrix3d turn;
  turn << 2, -2, 1, 1, 2, 2, -2, -1, 2;
  turn /= 3;
  REQUIRE((turn * turn.transpose()).isIdentity(1e-12));
  TriangleProblem problem = problem_of(patch, 0.1), turned = problem;
  turned.load = problem.load * turn.transpose();
  for (const auto side :
       {&EdgeTangents::su0, &EdgeTangents::su1, &EdgeTangents::sv0, &EdgeTangents::sv1}) {
    turned.tangents.*side = turn * problem.tangents.*side;
  }
  const PlateState start = at_rest(patch.cells, problem.load.rows());
  PlateState turned_start = start;
  turned_start.displacement = start.displacement * turn.transpose();
  TrianglePlate plate = plate_of(patch);
  const PlateState state = *plate.advance(problem, {3, 0.01}, start);
  const PlateState other = *plate.advance(turned, {3, 0.01}, turned_start);
  CHECK(largest(state.plastic) > 0.01);
  CHECK(largest(other.displacement - state.displacement * turn.transpose()) <
        1e-9 * largest(state.displacement));
  for (int row = 0; row < 3; ++row) {
    const Field here = state.plastic.middleCols<3>(3 * row);
    CHECK(largest(other.plastic.middleCols<3>(3 * row) - here * turn.transpose()) <
          1e-7 * largest(state.plastic));
  }
}

// The dent that an even load leaves in a clamped square.
TEST_CASE("triangles and a grid come to one dent", "[plate][plastic][morley]") {
  const Stiffness stiffness{1, 2, 1};
  const PlasticLaw law{0.03, 0.2};
  const auto by_grid = [&](int count) {
    const Grid grid = unit_grid(count + 1, count + 1);
    PlateProblem problem{grid, stiffness, {0, 0}, {}, {}, 0};
    problem.law = law;
    problem.load = Field::Zero(grid.node_count(), 3);
    PlateState state{problem.load, problem.load, PlasticField::Zero(grid.node_count(), 9)};
    const auto solver = make_plate_solver();
    std::vector<double> heights;
    for (const double q : {2.0, 0.0}) {
      problem.load.col(1).setConstant(q);
      state = *solver->advance(problem, {1, 1}, state);
      heights.push_back(state.displacement(grid.node(count / 2, count / 2), 1));
    }
    return heights;
  };
  const auto by_triangles = [&](int count, bool has_quads) {
    const Mesh mesh = square(count, 1, 0.2, has_quads);
    const TrianglePatch patch = patch_of(mesh, 9, Border::Clamped);
    const int middle = (count + 1) * (count + 1) / 2;  // jittered: the peak is flat there
    int place = 0;
    while (patch.points[place] != middle) ++place;
    TrianglePlate plate = plate_of(patch);
    TriangleProblem problem;
    problem.bending = bending_of(stiffness, {1, 1});
    problem.dynamics = {0, 0};
    problem.law = law;
    PlateState state = at_rest(patch.cells, static_cast<Eigen::Index>(patch.masses.size()));
    state.displacement.setZero();
    std::vector<double> heights;
    for (const double q : {2.0, 0.0}) {
      problem.load = Field::Zero(static_cast<Eigen::Index>(patch.masses.size()), 3);
      for (std::size_t k = 0; k < patch.masses.size(); ++k)
        problem.load(static_cast<Eigen::Index>(k), 1) = q * patch.masses[k];
      state = *plate.advance(problem, {1, 1}, state);
      heights.push_back(state.displacement(place, 1));
    }
    return heights;
  };
  const std::vector<double> exact = by_grid(96);
  CHECK(exact[0] > 1.05 * 2 * 0.00126532);  // more than elastic
  CHECK(exact[1] > 0.02 * exact[0]);
  for (const bool has_quads : {false, true}) {
    std::vector<double> coarse = by_triangles(16, has_quads), fine = by_triangles(32, has_quads);
    for (const int k : {0, 1}) {
      CAPTURE(has_quads, k, exact[k], coarse[k], fine[k]);
      CHECK(std::abs(fine[k] / exact[k] - 1) < 0.05);
      CHECK(std::abs(fine[k] - exact[k]) < 0.5 * std::abs(coarse[k] - exact[k]));
    }
  }
}
