#include "pliant/plate/outline/outline.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <tuple>

#include <Eigen/Cholesky>

#include "pliant/plate/advance.hpp"
#include "pliant/region/combine.hpp"
#include "support/catch.hpp"
#include "support/dense.hpp"
#include "support/plates.hpp"

using namespace pliant;
using pliant::testing::apply_stencil;
using pliant::testing::assemble_upper;
using pliant::testing::eigenvalues_of;
using pliant::testing::residual;
using pliant::testing::sampled;
using pliant::testing::unit_grid;

namespace {

InteriorMask mask_of(const Grid& grid, const std::function<bool(int, int)>& is_cell) {
  InteriorMask mask(static_cast<std::size_t>(grid.node_count()), 0);
  for (int j = 1; j < grid.rows - 1; ++j) {
    for (int i = 1; i < grid.columns - 1; ++i) {
      mask[grid.node(i, j)] =
          is_cell(i - 1, j - 1) && is_cell(i, j - 1) && is_cell(i - 1, j) && is_cell(i, j);
    }
  }
  return mask;
}

// All cells except a quarter.
InteriorMask ell(const Grid& grid) {
  return mask_of(
      grid, [&](int i, int j) { return !(2 * i >= grid.columns - 1 && 2 * j >= grid.rows - 1); });
}

// SPEC 4 and 5 computed in another way: every node of the region has a value or, beyond the rim, is
// the mirror image of a node; the stencil is a product of one-dimensional ones, summed in a map.
class SlowPlate {
 public:
  SlowPlate(const PlateSystem& system, InteriorMask interior)
      : system_(system), interior_(std::move(interior)) {}

  // Row of the matrix, as a map from nodes to weights.
  std::map<int, double> row(int i, int j) const {
    const auto& [b, c, d] = system_.stiffness;
    const double hu = system_.outline.grid().hu, hv = system_.outline.grid().hv;
    const int fourth[] = {1, -4, 6, -4, 1};
    const int second[] = {1, -2, 1};
    std::map<int, double> entries;
    entries[system_.outline.grid().node(i, j)] += system_.shift;
    for (int k = -2; k <= 2; ++k) {
      entries[seen(i, j, k, 0)] += b * fourth[k + 2] / std::pow(hu, 4);
      entries[seen(i, j, 0, k)] += d * fourth[k + 2] / std::pow(hv, 4);
    }
    for (int p = -1; p <= 1; ++p) {
      for (int q = -1; q <= 1; ++q) {
        entries[system_.outline.grid().node(i + p, j + q)] +=
            c * second[p + 1] * second[q + 1] / (hu * hu * hv * hv);
      }
    }
    return entries;
  }

  bool is_interior(int node) const { return interior_[node] != 0; }

  Eigen::MatrixXd dense() const {
    std::map<int, int> number;
    for (int node = 0; node < system_.outline.grid().node_count(); ++node) {
      if (is_interior(node)) number.emplace(node, static_cast<int>(number.size()));
    }
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(number.size(), number.size());
    for (const auto& [node, row_number] : number) {
      for (const auto& [other, weight] :
           row(node % system_.outline.grid().columns, node / system_.outline.grid().columns)) {
        if (number.contains(other)) matrix(row_number, number[other]) += weight;
      }
    }
    return matrix;
  }

 private:
  // The node at offset (di, dj), or the node that the ghost there mirrors.
  int seen(int i, int j, int di, int dj) const {
    const bool is_far = std::abs(di) + std::abs(dj) == 2;
    const bool is_ghost =
        is_far && !is_interior(system_.outline.grid().node(i + di / 2, j + dj / 2));
    return is_ghost ? system_.outline.grid().node(i, j)
                    : system_.outline.grid().node(i + di, j + dj);
  }

  PlateSystem system_;
  InteriorMask interior_;
};

// Boxes like those of forces, as one connected plate.
std::pair<Grid, InteriorMask> random_union(std::mt19937& random) {
  const auto pick = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  while (true) {
    std::vector<Box> boxes;
    for (int k = pick(2, 5); k > 0; --k) {
      const int i = pick(0, 7), j = pick(0, 7);
      boxes.push_back({i, i + pick(1, 6), j, j + pick(1, 6)});
    }
    const auto regions = combine(boxes, Combine::Union);
    for (const Patch& patch : regions.at(0).patches) {
      if (!patch.is_rectangle())
        return {{patch.box.columns(), patch.box.rows(), 0.25, 0.125}, patch.interior};
    }
  }
}

}  // namespace

// The solvers for any outline.
std::vector<SolverChoice> direct_solvers() {
  std::vector<SolverChoice> kinds = available_solvers();
  std::erase(kinds, SolverChoice::Spectral);
  return kinds;
}

TEST_CASE("interior rows go back to where they came from", "[plate]") {
  const Grid grid = unit_grid(6, 4);
  const Field nodes = Field::Random(grid.node_count(), 3);
  const Field interior = interior_of(grid, nodes);
  REQUIRE(interior.rows() == 8);
  for (int j = 1; j < 3; ++j) {
    for (int i = 1; i < 5; ++i) {
      CHECK(interior.row((j - 1) * 4 + i - 1) == nodes.row(grid.node(i, j)));
    }
  }
  CHECK(with_interior(grid, nodes, interior) == nodes);
  const Field changed = with_interior(grid, nodes, Field::Zero(8, 3));
  CHECK(interior_of(grid, changed).isZero(0));
  for (int i = 0; i < 6; ++i) {
    CHECK(changed.row(grid.node(i, 0)) == nodes.row(grid.node(i, 0)));
    CHECK(changed.row(grid.node(i, 3)) == nodes.row(grid.node(i, 3)));
  }
  Field cleared = nodes;
  clear_rim(grid, cleared);
  CHECK(cleared == with_interior(grid, Field::Zero(24, 3), interior));
}

TEST_CASE("an outline's runs, nodes near the rim and answers are those of its mask",
          "[plate][union]") {
  std::mt19937 random(17);
  for (int trial = 0; trial < 60; ++trial) {
    Grid grid;  // not a structured binding, which Clang does not let a lambda capture
    InteriorMask mask;
    std::tie(grid, mask) = random_union(random);
    if (trial % 6 == 0) mask = mask_of(grid, [](int, int) { return true; });
    const Outline outline = trial % 12 == 0 ? Outline(grid) : Outline(grid, mask);
    const auto holds = [&](int i, int j) {
      const bool is_node = i >= 0 && i < grid.columns && j >= 0 && j < grid.rows;
      return is_node && mask[grid.node(i, j)] != 0;
    };
    InteriorMask in_runs(mask.size(), 0), near(mask.size(), 0);
    int last = -1;
    outline.for_each_run([&](const Outline::Run& run) {
      CHECK(grid.node(run.i0, run.j) > last);
      last = grid.node(run.i1, run.j);
      CHECK_FALSE(holds(run.i0 - 1, run.j));
      CHECK_FALSE(holds(run.i1 + 1, run.j));
      for (int i = run.i0; i <= run.i1; ++i) in_runs[grid.node(i, run.j)] = 1;
    });
    CHECK(in_runs == mask);
    CHECK(outline.unknown_count() == std::count(mask.begin(), mask.end(), 1));
    outline.for_each_near_rim([&](int i, int j) { near[grid.node(i, j)] = 1; });
    int wrong = 0;
    for (int j = 0; j < grid.rows; ++j) {
      for (int i = 0; i < grid.columns; ++i) {
        wrong += outline.holds(i, j) != holds(i, j);
        bool is_deep = holds(i - 2, j) && holds(i + 2, j) && holds(i, j - 2) && holds(i, j + 2);
        for (int k = 0; k < 9; ++k) is_deep = is_deep && holds(i - 1 + k % 3, j - 1 + k / 3);
        const bool is_near = near[grid.node(i, j)] != 0;
        wrong += holds(i, j) ? !is_deep && !is_near : is_near;
        wrong += outline.is_rectangle() && is_deep && is_near;
      }
    }
    CHECK(wrong == 0);
    const Field nodes = Field::Random(grid.node_count(), 3);
    const Field zero = Field::Zero(grid.node_count(), 3);
    Field cleared = nodes;
    clear_rim(outline, cleared);
    CHECK(cleared == with_interior(outline, zero, interior_of(outline, nodes)));
  }
}

TEST_CASE("a mask of all but the rim is the rectangle, to the bit", "[plate][union]") {
  const Grid grid{9, 7, 0.25, 0.5};
  const InteriorMask all = mask_of(grid, [](int, int) { return true; });
  const Stiffness s{1.5, -0.7, 2.25};
  EdgeTangents tangents;
  tangents.su0 = {1, 2, 3};
  tangents.su1 = {-4, 5, 6};
  tangents.sv0 = {7, -8, 9};
  tangents.sv1 = {1, 3, -5};
  const Field w = Field::Random(grid.node_count(), 3);
  const Outline masked(grid, all);
  CHECK(masked.unknown_count() == unknown_count(grid));
  CHECK(apply_stencil(masked, s, tangents, w) == apply_stencil(grid, s, tangents, w));
  const Eigen::MatrixXd matrix = assemble_upper({masked, s, 3});
  CHECK(matrix == Eigen::MatrixXd(assemble_upper({grid, s, 3})));
  const Field x = Field::Random(35, 3), f = Field::Random(35, 3);
  CHECK(residual({masked, s, 3}, x, f) == residual({grid, s, 3}, x, f));
  CHECK(interior_of(masked, w) == interior_of(grid, w));
  CHECK(with_interior(masked, w, x) == with_interior(grid, w, x));
}

TEST_CASE("a union's matrix is that of a slow reading, symmetric and positive definite",
          "[plate][union]") {
  std::mt19937 random(11);
  for (int trial = 0; trial < 60; ++trial) {
    const auto [grid, interior] = random_union(random);
    const double b = 1.5, d = 0.75, shortfall = trial % 3 == 0 ? 1e-6 : 0.5;
    const double c = trial % 3 == 2 ? 3 : -2 * std::sqrt(b * d) * (1 - shortfall);
    const Outline outline(grid, interior);
    const PlateSystem system{outline, {b, c, d}, 0};
    const Eigen::MatrixXd dense = SlowPlate(system, interior).dense();
    const double scale = dense.cwiseAbs().maxCoeff();
    CHECK((dense - dense.transpose()).cwiseAbs().maxCoeff() < 1e-15 * scale);
    const Eigen::MatrixXd upper = assemble_upper(system);
    CHECK((upper - Eigen::MatrixXd(dense.triangularView<Eigen::Upper>())).cwiseAbs().maxCoeff() <
          1e-14 * scale);
    CHECK(eigenvalues_of(dense).minCoeff() > 0);
    // The operator, and the residual, applied to a field that is 0 on the rim.
    const Field w = Field::Random(dense.rows(), 3), f = Field::Random(dense.rows(), 3);
    const Field nodes = with_interior(outline, Field::Zero(grid.node_count(), 3), w);
    CHECK((apply_stencil(outline, system.stiffness, {}, nodes) - dense * w).cwiseAbs().maxCoeff() <
          1e-13 * scale);
    CHECK((residual(system, w, f) - (f - dense * w)).cwiseAbs().maxCoeff() < 1e-13 * scale);
  }
}

TEST_CASE("rim values enter as the slow reading says", "[plate][union]") {
  std::mt19937 random(13);
  const auto [grid, interior] = random_union(random);
  const PlateSystem system{{grid, interior}, {1.5, 0.5, 0.75}, 0};
  const SlowPlate slow(system, interior);
  const Field w = Field::Random(grid.node_count(), 3);
  const Field result = apply_stencil(system.outline, system.stiffness, {}, w);
  int number = 0;
  for (int node = 0; node < grid.node_count(); ++node) {
    if (!slow.is_interior(node)) continue;
    Eigen::RowVector3d expected = Eigen::RowVector3d::Zero();
    for (const auto& [other, weight] : slow.row(node % grid.columns, node / grid.columns)) {
      expected += weight * w.row(other);
    }
    CHECK((result.row(number++) - expected).norm() < 1e-11 * expected.norm() + 1e-9);
  }
}

TEST_CASE("solvers agree with dense Cholesky on unions and keep what they can",
          "[plate][union][solver]") {
  const auto solver = make_plate_solver(GENERATE(from_range(direct_solvers())));
  const Grid grid = unit_grid(15, 13);
  PlateSystem system{{grid, ell(grid)}, {1, 2, 1}, 7};
  const Eigen::MatrixXd dense = SlowPlate(system, ell(grid)).dense();
  const Field f = Field::Random(dense.rows(), 3);
  REQUIRE(solver->prepare(system));
  const Field w = solver->solve(f).value();
  CHECK((dense * w - f).norm() <= 1e-13 * (dense.norm() * w.norm() + f.norm()));
  REQUIRE(solver->prepare(system));
  CHECK(solver->counts().factorizations == 1);
  system.shift = 8;
  REQUIRE(solver->prepare(system));
  CHECK(solver->counts().analyses == 1);
  REQUIRE(solver->prepare({grid, {1, 2, 1}, 8}));  // as large, but not an L
  CHECK(solver->counts().analyses == 2);
  REQUIRE(solver->prepare({{grid, ell(grid)}, {1, 2, 1}, 7}));
  CHECK(solver->solve(f).value() == w);
}

TEST_CASE("an L-shape converges with order 2", "[plate][union]") {
  // Clamped on the whole outline: a product of squares with double zeros on all six sides, of which
  // two meet in the inner corner.
  const auto square = [](double x) { return x * x; };
  const auto w_exact = [&](double u, double v) {
    return square(u * (1 - u) * v * (1 - v)) * square(square(0.5 - u)) * square(square(0.5 - v));
  };
  // Its factors are x^2 (1-x)^2 (1/2-x)^4 in u and in v; derivatives by polynomial arithmetic.
  const auto derivative = [&](double x, int order) {
    std::vector<double> p{1};
    const auto times = [&](double a, double b) {  // (a + b x)
      std::vector<double> r(p.size() + 1, 0);
      for (std::size_t k = 0; k < p.size(); ++k) r[k] += a * p[k], r[k + 1] += b * p[k];
      p = r;
    };
    for (int k = 0; k < 2; ++k) times(0, 1), times(1, -1);
    for (int k = 0; k < 4; ++k) times(0.5, -1);
    for (int k = 0; k < order; ++k) {
      for (std::size_t n = 1; n < p.size(); ++n) p[n - 1] = static_cast<double>(n) * p[n];
      p.pop_back();
    }
    double sum = 0;
    for (std::size_t n = p.size(); n-- > 0;) sum = sum * x + p[n];
    return sum;
  };
  const Stiffness s{1.5, 0.5, 0.75};
  std::vector<double> errors;
  for (const int nodes : {17, 33, 65}) {
    const Grid grid = unit_grid(nodes, nodes);
    const Field exact = sampled(grid, w_exact);
    const Field load = sampled(grid, [&](double u, double v) {
      return s.b * derivative(u, 4) * derivative(v, 0) + s.c * derivative(u, 2) * derivative(v, 2) +
             s.d * derivative(u, 0) * derivative(v, 4);
    });
    const Outline outline(grid, ell(grid));
    const auto solver = make_plate_solver(available_solvers().front());
    const PlateProblem problem{outline, s, {0, 0}, {}, load};
    const PlateState start{Field::Zero(grid.node_count(), 3), Field::Zero(grid.node_count(), 3)};
    const auto solved = advance_in_steps(*solver, problem, {1, 1}, start).value();
    const Field difference = interior_of(outline, solved.displacement - exact);
    errors.push_back(difference.cwiseAbs().maxCoeff() / exact.cwiseAbs().maxCoeff());
  }
  CAPTURE(errors);
  CHECK(std::log2(errors[0] / errors[1]) >= 1.9);
  CHECK(std::log2(errors[1] / errors[2]) >= 1.9);
}

TEST_CASE("tangents act at the ends of a union and nowhere else", "[plate][union]") {
  const Grid grid = unit_grid(13, 13);
  const Outline outline(grid, ell(grid));
  EdgeTangents tangents;
  tangents.su1.setConstant(1);
  const Field zero = Field::Zero(grid.node_count(), 3);
  const Field felt = apply_stencil(outline, {1, 2, 1}, tangents, zero);
  Field unknowns = with_interior(outline, zero, felt);
  for (int j = 0; j < 13; ++j) {
    for (int i = 0; i < 13; ++i) {
      const bool is_beside_u1 = i == 11 && j >= 1 && j <= 5;  // not the inner side, at i = 6
      CHECK((unknowns(grid.node(i, j), 0) != 0) == is_beside_u1);
    }
  }
}
