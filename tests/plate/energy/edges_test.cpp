#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/SparseCholesky>

#include "pliant/plate/energy/plate_energy.hpp"
#include "pliant/plate/plate_solver.hpp"
#include "pliant/plate/solver_factories.hpp"
#include "support/catch.hpp"
#include "support/dense.hpp"
#include "support/plates.hpp"
#include "support/sanitized.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

Edge edge_of(char letter) {
  return letter == 'c' ? Edge::Clamped : letter == 'p' ? Edge::Pinned : Edge::Free;
}

// "cfpp": u0, u1, v0, v1.
Edges edges_of(std::string_view letters) {
  return {edge_of(letters[0]), edge_of(letters[1]), edge_of(letters[2]), edge_of(letters[3])};
}

// Factors that differ everywhere.
std::shared_ptr<const NodeFactors> uneven(const Grid& grid) {
  NodeFactors factors;
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) {
      factors.b.push_back(1 + 0.1 * i);
      factors.c.push_back(1.5 + 0.3 * std::sin(i + 2.0 * j));
      factors.d.push_back(0.7 + 0.05 * (i * j % 7));
    }
  }
  return std::make_shared<const NodeFactors>(factors);
}

// The energy of one component, written once more as a sum over nodes and cells.
double energy_by_hand(const PlateSystem& system, const Eigen::VectorXd& w,
                      const std::array<double, 4>& slopes) {
  const Grid& grid = system.outline.grid();
  const Edges& edges = system.outline.edges();
  const auto at = [&](int i, int j) { return w[grid.node_round(i, j)]; };
  struct Curvature {
    bool is_there;
    double value;
  };
  const auto along = [&](int line, int count, double h, bool is_closed, Edge first, Edge last,
                         const std::array<double, 2>& slope, const auto& value) -> Curvature {
    if (!is_closed && line == 0) {
      return {first == Edge::Clamped, 2 * (value(1) - value(0) - h * slope[0]) / (h * h)};
    }
    if (!is_closed && line == count - 1) {
      return {last == Edge::Clamped, 2 * (value(-1) - value(0) + h * slope[1]) / (h * h)};
    }
    return {true, (value(-1) - 2 * value(0) + value(1)) / (h * h)};
  };
  const auto moduli = [&](int i, int j) {
    const int node = grid.node_round(i, j);
    const double b = system.stiffness.b * (system.factors ? system.factors->b[node] : 1);
    const double c = system.stiffness.c * (system.factors ? system.factors->c[node] : 1);
    const double d = system.stiffness.d * (system.factors ? system.factors->d[node] : 1);
    const double gamma = system.poisson * std::sqrt(b * d);
    return std::array{b, gamma, d, c - 2 * gamma};
  };
  double energy = 0;
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) {
      const Curvature u = along(i, grid.columns, grid.hu, grid.is_closed_u, edges.u0, edges.u1,
                                {slopes[0], slopes[1]}, [&](int step) { return at(i + step, j); });
      const Curvature v = along(j, grid.rows, grid.hv, grid.is_closed_v, edges.v0, edges.v1,
                                {slopes[2], slopes[3]}, [&](int step) { return at(i, j + step); });
      const double area = (!grid.is_closed_u && i % (grid.columns - 1) == 0 ? 0.5 : 1) *
                          (!grid.is_closed_v && j % (grid.rows - 1) == 0 ? 0.5 : 1);
      const auto [b, gamma, d, tau] = moduli(i, j);
      const double left = 1 - system.poisson * system.poisson;
      if (u.is_there && v.is_there) {
        energy += area / 2 *
                  (b * u.value * u.value + 2 * gamma * u.value * v.value + d * v.value * v.value);
      } else if (u.is_there) {
        energy += area / 2 * left * b * u.value * u.value;
      } else if (v.is_there) {
        energy += area / 2 * left * d * v.value * v.value;
      }
      const bool is_cell =
          (grid.is_closed_u || i + 1 < grid.columns) && (grid.is_closed_v || j + 1 < grid.rows);
      if (!is_cell) continue;
      const double twist =
          (at(i, j) - at(i + 1, j) - at(i, j + 1) + at(i + 1, j + 1)) / (grid.hu * grid.hv);
      const double mean =
          (moduli(i, j)[3] + moduli(i + 1, j)[3] + moduli(i, j + 1)[3] + moduli(i + 1, j + 1)[3]) /
          4;
      energy += mean * twist * twist / 2;
    }
  }
  return energy;
}

Eigen::MatrixXd dense(const PlateSystem& system) {
  const int count = system.outline.grid().node_count();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count, count);
  PlateEnergy(system).hessian<double>().for_each([&](int node, int other, double entry) {
    matrix(node, other) += entry;
    if (node != other) matrix(other, node) += entry;
  });
  return matrix;
}

// The rows and columns of the unknowns.
Eigen::MatrixXd of_unknowns(const Outline& outline, const Eigen::MatrixXd& matrix) {
  const std::vector<int> numbers = numbers_of_unknowns(outline);
  Eigen::MatrixXd result(outline.unknown_count(), outline.unknown_count());
  for (std::size_t p = 0; p < numbers.size(); ++p) {
    for (std::size_t q = 0; q < numbers.size(); ++q) {
      if (numbers[p] >= 0 && numbers[q] >= 0) {
        result(numbers[p], numbers[q]) =
            matrix(static_cast<Eigen::Index>(p), static_cast<Eigen::Index>(q));
      }
    }
  }
  return result;
}

// The nodes' shares of area, of the unknowns.
Eigen::VectorXd shares_of(const Outline& outline) {
  const PlateSystem system{outline, {}, 0};
  const PlateEnergy energy(system);
  Field shares(outline.grid().node_count(), 3);
  for (int j = 0; j < outline.grid().rows; ++j) {
    for (int i = 0; i < outline.grid().columns; ++i) {
      shares.row(outline.grid().node(i, j)).setConstant(energy.share(i, j));
    }
  }
  return interior_of(outline, shares).col(0);
}

constexpr double poisson = 0.3;

// The two lowest frequencies of the isotropic unit plate, rigid motions left out: by subspace
// iteration on (K + M)^-1 M.
std::array<double, 2> frequencies(std::string_view edges, int side) {
  const Outline outline(unit_grid(side, side), edges_of(edges));
  const PlateSystem system{outline, {1, 2, 1}, 0, poisson};
  const std::vector<int> numbers = numbers_of_unknowns(outline);
  const Eigen::VectorXd masses = shares_of(outline);
  std::vector<Eigen::Triplet<double>> entries;
  PlateEnergy(system).hessian<double>().for_each([&](int node, int other, double entry) {
    const int one = numbers[node], two = numbers[other];
    if (one < 0 || two < 0) return;
    entries.emplace_back(one, two, entry);
    if (one != two) entries.emplace_back(two, one, entry);
  });
  for (int k = 0; k < masses.size(); ++k) entries.emplace_back(k, k, masses[k]);
  Eigen::SparseMatrix<double> shifted(masses.size(), masses.size());
  shifted.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(shifted);
  Eigen::MatrixXd shapes(masses.size(), 8);
  for (Eigen::Index k = 0; k < shapes.size(); ++k) {
    shapes.data()[k] = std::sin(12.9898 * static_cast<double>(k + 1));
  }
  Eigen::VectorXd values;
  for (int pass = 0; pass < 60; ++pass) {
    const Eigen::MatrixXd next = factor.solve(masses.asDiagonal() * shapes);
    const Eigen::MatrixXd stiff = next.transpose() * (masses.asDiagonal() * shapes);
    const Eigen::MatrixXd mass = next.transpose() * (masses.asDiagonal() * next);
    const Modes modes = modes_of((stiff + stiff.transpose()) / 2, (mass + mass.transpose()) / 2);
    values = modes.values;
    shapes = next * modes.vectors;
  }
  std::vector<double> found;
  for (const double value : values) {
    if (value - 1 > 1e-3) found.push_back(std::sqrt(value - 1));
  }
  return {found.at(0), found.at(1)};
}

// Deflections of the isotropic unit plate under a uniform load of 1, at the centre and at the
// middle of the edge u1.
std::array<double, 2> deflections(std::string_view edges, int side) {
  const Outline outline(unit_grid(side, side), edges_of(edges));
  const auto solver = make_plate_solver();
  const Field zero = Field::Zero(outline.grid().node_count(), 3);
  const PlateProblem problem{outline, {1, 2, 1}, {0, 0}, {}, Field::Ones(zero.rows(), 3), poisson};
  const auto state = solver->advance(problem, {1, 1}, {zero, zero});
  REQUIRE(state.has_value());
  const Grid& grid = outline.grid();
  return {state->displacement(grid.node(side / 2, side / 2), 1),
          state->displacement(grid.node(side - 1, side / 2), 1)};
}

// Two values at spacings h and h/2 extrapolated to 0, for an error of O(h^2).
double limit(double coarse, double fine) { return fine + (fine - coarse) / 3; }

// Observed order, of the differences of three values at h, h/2, h/4.
double order(double one, double two, double three) {
  return std::log2(std::abs((one - two) / (two - three)));
}

const std::vector<std::string> all_edges = {"cccc", "pppp", "cfff", "ffff", "ppff", "ccpp",
                                            "cppp", "pfpp", "cfpp", "pccf", "fcpf"};

}  // namespace

TEST_CASE("The Hessian is that of the energy, which is written as a sum of nodes and cells",
          "[plate][edges]") {
  for (const std::string& edges : all_edges) {
    for (const bool is_uneven : {false, true}) {
      for (const int closed : {0, 1, 2, 3}) {
        CAPTURE(edges, is_uneven, closed);
        Grid grid = unit_grid(6, 5);
        grid.is_closed_u = closed % 2 == 1;
        grid.is_closed_v = closed / 2 == 1;
        PlateSystem system{{grid, edges_of(edges)}, {1.5, 2, 0.75}, 0, 0.25};
        if (is_uneven) system.factors = uneven(grid);
        const Eigen::MatrixXd matrix = dense(system);
        for (int seed = 0; seed < 3; ++seed) {
          const Eigen::VectorXd w = Eigen::VectorXd::Random(grid.node_count());
          CHECK_THAT(w.dot(matrix * w) / 2, WithinRel(energy_by_hand(system, w, {}), 1e-12));
        }
        // The energy is quadratic, so that central differences are exact: the tangents' forces are
        // what the slopes add to minus its gradient.
        const std::array<double, 4> slopes = {0.5, -1, 2, 0.25};
        EdgeTangents tangents;
        tangents.su0.setConstant(slopes[0]);
        tangents.su1.setConstant(slopes[1]);
        tangents.sv0.setConstant(slopes[2]);
        tangents.sv1.setConstant(slopes[3]);
        Field forces = Field::Zero(grid.node_count(), 3);
        PlateEnergy(system).add_tangents(tangents, forces);
        for (int node = 0; node < grid.node_count(); ++node) {
          const Eigen::VectorXd step = Eigen::VectorXd::Unit(grid.node_count(), node);
          const double gradient =
              (energy_by_hand(system, step, slopes) - energy_by_hand(system, -step, slopes)) / 2;
          CHECK_THAT(forces(node, 1), WithinAbs(-gradient, 1e-9 * matrix.cwiseAbs().maxCoeff()));
        }
      }
    }
  }
}

TEST_CASE("With clamped edges the Hessian is the stencil, whatever Poisson's ratio",
          "[plate][edges]") {
  for (const double ratio : {0.0, 0.3, -0.9, 2.0}) {
    const Outline outline(unit_grid(9, 7));
    const PlateSystem system{outline, {1.5, -0.7, 2.25}, 0, ratio};
    const Eigen::MatrixXd matrix = of_unknowns(outline, dense(system));
    const Eigen::MatrixXd stencil = dense_operator(system);
    CHECK((matrix - stencil).cwiseAbs().maxCoeff() < 1e-12 * stencil.cwiseAbs().maxCoeff());
  }
}

TEST_CASE("A plate from its energy moves as one from the stencil, beside a displaced rim",
          "[plate][edges]") {
  const Outline outline(unit_grid(11, 8));
  const int count = outline.grid().node_count();
  EdgeTangents tangents;
  tangents.su0 = {1, 2, -1};
  tangents.sv1 = {0.5, 0, 3};
  PlateProblem problem{outline, {1.5, 0.5, 2}, {2, 3}, tangents, 1e3 * Field::Random(count, 3),
                       0.4};
  const PlateState start{Field::Random(count, 3), Field::Random(count, 3)};
  const TimeSteps steps{5, 0.01};
  const auto other = make_sparse_solver()->advance(problem, steps, start);
  // A map of the stiffness takes the energy, even where it is 1.
  NodeFactors even;
  even.b.assign(static_cast<std::size_t>(count), 1);
  problem.factors = std::make_shared<const NodeFactors>(even);
  const auto one = make_sparse_solver()->advance(problem, steps, start);
  REQUIRE((one && other));
  CHECK((one->displacement - other->displacement).cwiseAbs().maxCoeff() < 1e-10);
  CHECK((one->velocity.array() - other->velocity.array()).abs().maxCoeff() < 1e-8);
}

TEST_CASE("Only rigid motions bend a free plate nowhere", "[plate][edges]") {
  for (const bool is_uneven : {false, true}) {
    const Grid grid = unit_grid(7, 6);
    PlateSystem system{{grid, edges_of("ffff")}, {1.5, 2, 0.75}, 0, 0.25};
    if (is_uneven) system.factors = uneven(grid);
    const Eigen::MatrixXd matrix = dense(system);
    const Eigen::VectorXd values = eigenvalues_of(matrix);
    const double largest = values.maxCoeff();
    CHECK(values(2) < 1e-13 * largest);
    CHECK(values(3) > 1e-6 * largest);
    for (int j = 0; j < 3; ++j) {
      Eigen::VectorXd rigid(grid.node_count());
      for (int node = 0; node < grid.node_count(); ++node) {
        rigid[node] = j == 0 ? 1 : j == 1 ? node % grid.columns : node / grid.columns;
      }
      CHECK((matrix * rigid).cwiseAbs().maxCoeff() < 1e-12 * largest);
    }
  }
}

// Sources: Timoshenko & Woinowsky-Krieger, Theory of Plates and Shells, 1959, tables 8, 46 to 48;
// Leissa, The free vibration of rectangular plates, J. Sound Vib. 31, 1973.
TEST_CASE("Square plates vibrate and bend as in the literature", "[plate][edges]") {
  struct Row {
    std::string edges;
    double first, second, centre, at_u1;
  };
  const Row row =
      GENERATE(Row{"cccc", 35.985, 73.39, 0.00126532, 0},
               Row{"pppp", 19.739, 49.348, 0.00406235, 0}, Row{"cfff", 3.471, 8.506, 0, 0.12908},
               Row{"ffff", 13.468, 19.596, 0, 0}, Row{"ppff", 9.631, 16.135, 0.013094, 0},
               Row{"ccpp", 28.951, 54.743, 0.0019172, 0}, Row{"cppp", 23.646, 51.674, 0.0027855, 0},
               Row{"pfpp", 11.685, 27.756, 0, 0.012852}, Row{"cfpp", 12.687, 33.065, 0, 0});
  CAPTURE(row.edges);
  if (is_sanitized) return;  // the rest is about figures
  const std::array<double, 2> coarse = frequencies(row.edges, 17);
  const std::array<double, 2> middle = frequencies(row.edges, 33);
  const std::array<double, 2> fine = frequencies(row.edges, 65);
  CHECK_THAT(limit(middle[0], fine[0]), WithinRel(row.first, 1e-4));
  CHECK_THAT(limit(middle[1], fine[1]), WithinRel(row.second, 1e-4));
  CHECK_THAT(order(coarse[0], middle[0], fine[0]), WithinAbs(2, 0.1));
  CHECK_THAT(order(coarse[1], middle[1], fine[1]), WithinAbs(2, 0.1));
  for (const int place : {0, 1}) {
    const double known = place == 0 ? row.centre : row.at_u1;
    if (known == 0) continue;
    const double one = deflections(row.edges, 17)[place], two = deflections(row.edges, 33)[place];
    const double three = deflections(row.edges, 65)[place];
    CHECK_THAT(limit(two, three), WithinRel(known, 5e-5));
    CHECK_THAT(order(one, two, three), WithinAbs(2, 0.1));
  }
}

TEST_CASE("The middle of a free edge bends as in the literature", "[plate][edges]") {
  if (is_sanitized) return;
  const auto at_edge = [](int side) {
    const Outline outline(unit_grid(side, side), edges_of("ppff"));
    const auto solver = make_plate_solver();
    const Field zero = Field::Zero(outline.grid().node_count(), 3);
    const PlateProblem problem{outline, {1, 2, 1}, {0, 0}, {}, Field::Ones(zero.rows(), 3),
                               poisson};
    return solver->advance(problem, {1, 1}, {zero, zero})
        .value()
        .displacement(outline.grid().node(side / 2, side - 1), 0);
  };
  CHECK_THAT(limit(at_edge(33), at_edge(65)), WithinRel(0.015011, 5e-5));
}

TEST_CASE("Pinned edges in sine space agree with the energy", "[plate][edges][spectral]") {
  const std::string edges = GENERATE(as<std::string>(), "pppp", "ccpp", "ppcc", "cppp", "pcpp",
                                     "ppcp", "pppc", "cpcp", "pccp", "cpcc", "pcpc", "ccpc");
  CAPTURE(edges);
  for (const auto& [columns, rows] : {std::pair{14, 11}, {9, 16}}) {
    const Outline outline(unit_grid(columns, rows), edges_of(edges));
    const int count = outline.grid().node_count();
    const Field zero = Field::Zero(count, 3);
    EdgeTangents tangents;
    if (edges[0] == 'c') tangents.su0 = {1, 2, 3};
    if (edges[3] == 'c') tangents.sv1 = {-1, 0, 2};
    for (const Integrator integrator : {Integrator::BackwardEuler, Integrator::Newmark}) {
      const PlateProblem problem{
          outline,
          {1.5, 0.5, 2},
          {2, 3},
          tangents,
          with_interior(outline, zero, 1e3 * Field::Random(outline.unknown_count(), 3))};
      const PlateState start{
          with_interior(outline, zero, Field::Random(outline.unknown_count(), 3)),
          with_interior(outline, zero, Field::Random(outline.unknown_count(), 3))};
      const TimeSteps steps{4, 0.01, integrator};
      const auto one = make_spectral_solver({})->advance(problem, steps, start);
      const auto other = make_sparse_solver()->advance(problem, steps, start);
      REQUIRE((one && other));
      CHECK((one->displacement - other->displacement).cwiseAbs().maxCoeff() < 1e-9);
      CHECK((one->velocity - other->velocity).cwiseAbs().maxCoeff() < 1e-7);
    }
    const PlateSystem system{outline, {1.5, 0.5, 2}, 3};
    const Field f = Field::Random(outline.unknown_count(), 3);
    const auto spectral = make_spectral_solver({});
    const auto energy = make_sparse_solver();
    REQUIRE((spectral->prepare(system) && energy->prepare(system)));
    const Field one = *spectral->solve(f), other = *energy->solve(f);
    CHECK((one - other).cwiseAbs().maxCoeff() < 1e-10 * other.cwiseAbs().maxCoeff());
  }
}

TEST_CASE("Factors of density and damping weigh the nodes, in any outline", "[plate][edges]") {
  const Grid grid = unit_grid(8, 7);
  InteriorMask mask(static_cast<std::size_t>(grid.node_count()));
  for (int j = 1; j < 6; ++j) {
    for (int i = 1; i < 7; ++i) mask[grid.node(i, j)] = i < 4 || j < 4;
  }
  for (const Outline& outline :
       {Outline(grid), Outline(grid, mask), Outline(grid, edges_of("fcpf"))}) {
    NodeFactors factors;
    for (int node = 0; node < grid.node_count(); ++node) {
      factors.density.push_back(1 + 0.1 * node);
      factors.damping.push_back(2 - 0.03 * node);
    }
    const PlateProblem problem{outline,
                               {1.5, 0.5, 2},
                               {2, 3},
                               {},
                               100 * Field::Random(grid.node_count(), 3),
                               0.2,
                               std::make_shared<const NodeFactors>(factors)};
    const double dt = 0.02;
    const Eigen::VectorXd shares = shares_of(outline);
    const Eigen::MatrixXd K = outline.mask().empty()
                                  ? of_unknowns(outline, dense(problem.system(dt)))
                                  : dense_operator({outline, {1.5, 0.5, 2}, 0});
    Field as_field = Field::Zero(grid.node_count(), 3);
    for (int node = 0; node < grid.node_count(); ++node) {
      as_field.row(node) << factors.density[node], factors.damping[node], 0;
    }
    const Field at_unknowns = interior_of(outline, as_field);
    const Eigen::VectorXd rho = 2 * shares.cwiseProduct(at_unknowns.col(0));
    const Eigen::VectorXd eta = 3 * shares.cwiseProduct(at_unknowns.col(1));
    const Field zero = Field::Zero(grid.node_count(), 3);
    const PlateState start{with_interior(outline, zero, Field::Random(shares.size(), 3)),
                           with_interior(outline, zero, Field::Random(shares.size(), 3))};
    Eigen::MatrixXd system = K;
    system.diagonal() += rho / (dt * dt) + eta / dt;
    const Field w = interior_of(outline, start.displacement);
    const Field v = interior_of(outline, start.velocity);
    const Field right = shares.asDiagonal() * interior_of(outline, problem.load) +
                        (rho / (dt * dt) + eta / dt).asDiagonal() * w + (rho / dt).asDiagonal() * v;
    const Field expected = system.ldlt().solve(right);
    const auto state = make_plate_solver()->advance(problem, {1, dt}, start);
    REQUIRE(state.has_value());
    const Field found = interior_of(outline, state->displacement);
    CHECK((found - expected).cwiseAbs().maxCoeff() < 1e-11 * expected.cwiseAbs().maxCoeff());
  }
}
