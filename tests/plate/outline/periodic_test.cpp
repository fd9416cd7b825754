#include <array>
#include <random>
#include <utility>
#include <vector>

#include "pliant/plate/advance.hpp"
#include "pliant/plate/plate_solver.hpp"
#include "pliant/plate/rim_load.hpp"
#include "pliant/plate/vibration.hpp"
#include "support/catch.hpp"
#include "support/plates.hpp"

using namespace pliant;
using pliant::testing::assemble_upper;
using pliant::testing::residual;
using namespace pliant::testing;

namespace {

constexpr int steps_of_stencil[13][2] = {{0, -2}, {-1, -1}, {0, -1}, {1, -1}, {-2, 0},
                                         {-1, 0}, {0, 0},   {1, 0},  {2, 0},  {-1, 1},
                                         {0, 1},  {1, 1},   {0, 2}};

// The matrix of docs/model.md, eq. (4), (5), (12) and (49), term by term: its nodes are found by
// remainders, and its unknowns by a search.
class SlowClosedPlate {
 public:
  explicit SlowClosedPlate(const PlateSystem& system)
      : system_(system), grid_(system.outline.grid()) {
    for (int j = 0; j < grid_.rows; ++j) {
      for (int i = 0; i < grid_.columns; ++i) {
        if (is_unknown(i, j)) unknowns_.emplace_back(i, j);
      }
    }
  }

  Eigen::MatrixXd matrix() const {
    const auto count = static_cast<Eigen::Index>(unknowns_.size());
    Eigen::MatrixXd result = system_.shift * Eigen::MatrixXd::Identity(count, count);
    for (std::size_t row = 0; row < unknowns_.size(); ++row) {
      for (const auto& [di, dj] : steps_of_stencil) {
        const auto column = place(unknowns_[row], di, dj);
        if (column >= 0) result(static_cast<Eigen::Index>(row), column) += weight(di, dj);
      }
    }
    return result;
  }

 private:
  static int modulo(int line, int count) { return (line % count + count) % count; }

  bool is_unknown(int i, int j) const {
    if (grid_.is_closed_u) i = modulo(i, grid_.columns);
    if (grid_.is_closed_v) j = modulo(j, grid_.rows);
    if (i < 0 || j < 0 || i >= grid_.columns || j >= grid_.rows) return false;
    const InteriorMask& mask = system_.outline.mask();
    if (!mask.empty()) return mask[static_cast<std::size_t>(j * grid_.columns + i)] != 0;
    return (grid_.is_closed_u || (i > 0 && i + 1 < grid_.columns)) &&
           (grid_.is_closed_v || (j > 0 && j + 1 < grid_.rows));
  }

  // The number of the unknown that a step of the stencil meets; -1: it meets the rim.
  Eigen::Index place(std::pair<int, int> from, int di, int dj) const {
    auto [i, j] = from;
    const bool is_far = di * di + dj * dj == 4;
    if (!(is_far && !is_unknown(i + di / 2, j + dj / 2))) i += di, j += dj;  // else its ghost
    if (!is_unknown(i, j)) return -1;
    if (grid_.is_closed_u) i = modulo(i, grid_.columns);
    if (grid_.is_closed_v) j = modulo(j, grid_.rows);
    for (std::size_t k = 0; k < unknowns_.size(); ++k) {
      if (unknowns_[k] == std::pair(i, j)) return static_cast<Eigen::Index>(k);
    }
    return -1;
  }

  double weight(int di, int dj) const {
    const std::array<double, 3> fourth = {6, -4, 1}, second = {-2, 1, 0};
    const int u = std::abs(di), v = std::abs(dj);
    const double hu = grid_.hu * grid_.hu, hv = grid_.hv * grid_.hv;
    const auto& [b, c, d] = system_.stiffness;
    return (v == 0 ? b * fourth[u] / (hu * hu) : 0) + c * second[u] * second[v] / (hu * hv) +
           (u == 0 ? d * fourth[v] / (hv * hv) : 0);
  }

  PlateSystem system_;
  Grid grid_;
  std::vector<std::pair<int, int>> unknowns_;
};

// Interior nodes of a random set of cells of a closed grid, counted round.
InteriorMask random_mask(const Grid& grid, std::mt19937& random) {
  std::bernoulli_distribution is_cell(0.8);
  std::vector<std::uint8_t> cells(static_cast<std::size_t>(grid.node_count()));
  for (auto& cell : cells) cell = is_cell(random);
  InteriorMask mask(cells.size(), 0);
  const auto cell = [&](int i, int j) {
    if ((!grid.is_closed_u && (i < 0 || i + 1 >= grid.columns)) ||
        (!grid.is_closed_v && (j < 0 || j + 1 >= grid.rows)))
      return false;
    return cells[static_cast<std::size_t>(grid.node_round(i, j))] != 0;
  };
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) {
      mask[static_cast<std::size_t>(grid.node(i, j))] =
          cell(i, j) && cell(i - 1, j) && cell(i, j - 1) && cell(i - 1, j - 1);
    }
  }
  return mask;
}

std::vector<Outline> closed_outlines() {
  std::mt19937 random(11);
  std::vector<Outline> outlines;
  for (const auto& [columns, rows] : {std::pair{3, 3}, {4, 3}, {3, 5}, {5, 4}, {7, 6}, {9, 11}}) {
    for (int closed = 1; closed < 4; ++closed) {
      const Grid grid{columns, rows, 0.25, 0.5, (closed & 1) != 0, (closed & 2) != 0};
      outlines.emplace_back(grid);
      for (int trial = 0; trial < 4; ++trial) {
        InteriorMask mask = random_mask(grid, random);
        if (std::count(mask.begin(), mask.end(), 1) > 0) outlines.emplace_back(grid, mask);
      }
    }
  }
  return outlines;
}

std::vector<SolverChoice> all_choices() {
  std::vector<SolverChoice> choices = available_solvers();
  choices.push_back(SolverChoice::Auto);
  return choices;
}

// `nodes` moved by `by` columns round the grid.
Field turned(const Grid& grid, const Field& nodes, int by) {
  Field result(nodes.rows(), 3);
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i)
      result.row(grid.node((i + by) % grid.columns, j)) = nodes.row(grid.node(i, j));
  }
  return result;
}

}  // namespace

TEST_CASE("a closed plate's matrix, stencil and residual are those that go round",
          "[plate][periodic]") {
  int with_rim = 0, without = 0;
  for (const Outline& outline : closed_outlines()) {
    const PlateSystem system{outline, {1.5, -0.7, 2.25}, 3};
    CAPTURE(outline.grid().columns, outline.grid().rows, outline.grid().is_closed_u,
            outline.grid().is_closed_v, outline.mask());
    const Eigen::MatrixXd slow = SlowClosedPlate(system).matrix();
    const double scale = slow.cwiseAbs().maxCoeff();
    REQUIRE(slow.rows() == outline.unknown_count());
    CHECK((slow - slow.transpose()).isZero(1e-15 * scale));
    CHECK((dense_operator(system) - slow).isZero(1e-14 * scale));
    const Eigen::MatrixXd upper = assemble_upper(system);
    CHECK((upper - Eigen::MatrixXd(slow.triangularView<Eigen::Upper>())).isZero(1e-14 * scale));
    const Field w = Field::Random(slow.rows(), 3), f = Field::Random(slow.rows(), 3);
    CHECK((residual(system, w, f) - (f - slow * w)).isZero(1e-13 * scale));
    (outline.is_unheld() ? without : with_rim) += 1;
  }
  CHECK(with_rim > 40);
  CHECK(without == 6);
}

TEST_CASE("every solver solves a closed plate", "[plate][periodic]") {
  for (const SolverChoice choice : all_choices()) {
    for (const Outline& outline : closed_outlines()) {
      const PlateSystem system{outline, {1.5, -0.7, 2.25}, outline.is_unheld() ? 2.5 : 0};
      const auto solver = make_plate_solver(choice);
      REQUIRE(solver->prepare(system));
      const Field f = Field::Random(outline.unknown_count(), 3);
      const Field expected = SlowClosedPlate(system).matrix().fullPivLu().solve(f);
      // The condition number is at most 1e4 here.
      CHECK((solver->solve(f).value() - expected).norm() < 1e-11 * expected.norm());
    }
  }
}

TEST_CASE("the rim's part of a load is that of the stencil on a closed outline",
          "[plate][periodic]") {
  EdgeTangents tangents;
  tangents.su0 = {1, 2, 3};
  tangents.su1 = {-4, 5, 6};
  tangents.sv0 = {7, -8, 9};
  tangents.sv1 = {1, 3, -5};
  const Stiffness stiffness{1.5, 0.75, 3};
  for (const Outline& outline : closed_outlines()) {
    const int nodes = outline.grid().node_count();
    const Field w = Field::Random(nodes, 3), load = Field::Random(nodes, 3);
    Field changed = load;
    subtract_rim(outline, stiffness, tangents, w, changed);
    const Field rim = with_interior(outline, w, Field::Zero(outline.unknown_count(), 3));
    const Field expected =
        interior_of(outline, load) - apply_stencil(outline, stiffness, tangents, rim);
    CHECK((interior_of(outline, changed) - expected).isZero(1e-11));
    // A closed direction has no tangents.
    const Field zero = Field::Zero(nodes, 3);
    EdgeTangents others = tangents;
    if (outline.grid().is_closed_u) others.su0 = others.su1 = {0, 0, 0};
    if (outline.grid().is_closed_v) others.sv0 = others.sv1 = {0, 0, 0};
    CHECK(apply_stencil(outline, stiffness, tangents, zero) ==
          apply_stencil(outline, stiffness, others, zero));
  }
}

TEST_CASE("a ring that is turned moves as it did before, turned", "[plate][periodic]") {
  const Grid grid{16, 9, 0.25, 0.5, true, false};
  PlateProblem problem{grid, {1.5, 0.5, 2}, {40, 20}, {}, Field::Random(grid.node_count(), 3)};
  problem.tangents.sv0 = {1, 2, 3};
  problem.tangents.su0 = {9, 9, 9};  // counts for nothing
  const PlateState start = random_state(grid);
  const auto solver = make_plate_solver();
  const PlateState end = solver->advance(problem, {5, 0.01}, start).value();
  for (const int by : {1, 7, 15}) {
    PlateProblem other = problem;
    other.load = turned(grid, problem.load, by);
    const PlateState moved =
        solver
            ->advance(other, {5, 0.01},
                      {turned(grid, start.displacement, by), turned(grid, start.velocity, by)})
            .value();
    CHECK((moved.displacement - turned(grid, end.displacement, by)).isZero(1e-12));
    CHECK((moved.velocity - turned(grid, end.velocity, by)).isZero(1e-11));
  }
}

TEST_CASE("a ring loaded evenly bends as a strip between its two rims", "[plate][periodic]") {
  // No difference along u: d w_vvvv = F with clamped ends, w = F/(24 d) v²(1 - v)², which the
  // central differences with mirrored ghosts solve up to F/(24 d) 2 h² v (1 - v).
  const int rows = 33;
  const double h = 1.0 / (rows - 1), d = 2;
  const Grid grid{12, rows, 0.1, h, true, false};
  const PlateSystem system{grid, {1.5, 0.5, d}, 0};
  const auto solver = make_plate_solver();
  REQUIRE(solver->prepare(system));
  const Field w = solver->solve(Field::Constant(unknown_count(grid), 3, 24 * d)).value();
  int row = 0;
  for (int j = 1; j + 1 < rows; ++j) {
    const double v = j * h, x = v * (1 - v);
    for (int i = 0; i < grid.columns; ++i) {
      const double here = w(row++, 1);
      CHECK_THAT(here, WithinAbs(x * x + 2 * h * h * x, 1e-11));
    }
  }
}

TEST_CASE("the slowest vibration of a torus is no rigid motion", "[plate][periodic]") {
  for (const Grid& grid : {Grid{9, 14, 0.1, 0.2, true, true}, Grid{20, 4, 1, 1, true, true},
                           Grid{3, 3, 1e3, 2e3, true, true}}) {
    const Stiffness stiffness{2, 1, 0.5};
    const auto solver = make_plate_solver();
    const double lambda = smallest_eigenvalue(*solver, {grid, stiffness, 0}).value();
    // Waves along one direction only, of (2 - 2 cos)^2/h^4.
    const auto slowest = [](int count, double h, double factor) {
      const double sine = std::sin(std::numbers::pi / count);
      return factor * std::pow(4 * sine * sine / (h * h), 2);
    };
    const double expected = std::min(slowest(grid.columns, grid.hu, stiffness.b),
                                     slowest(grid.rows, grid.hv, stiffness.d));
    CHECK_THAT(lambda, WithinRel(expected, 1e-9));
  }
}

TEST_CASE("the slowest vibration of a ring is that of its strip", "[plate][periodic]") {
  // Free of differences along u: a clamped beam, λ = d β⁴ with cos β cosh β = 1.
  const int rows = 65;
  const Grid grid{8, rows, 0.05, 1.0 / (rows - 1), true, false};
  const auto solver = make_plate_solver();
  const auto plate = vibrating(*solver, {grid, {1, 2, 1}, 0}).value();
  const double lambda = smallest_eigenvalue(plate).value();
  CHECK_THAT(std::sqrt(lambda), WithinRel(4.730040744862704 * 4.730040744862704, 2e-3));
}
