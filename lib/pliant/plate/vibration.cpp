#include "pliant/plate/vibration.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>

#include "pliant/core/expects.hpp"
#include "pliant/plate/energy/plate_energy.hpp"

namespace pliant {
namespace {

// Shapes that satisfy the clamped rim: a bump, and the bump made odd along u and along v. For any
// symmetry of the slowest vibration, one of them has a component along it.
Field starting_shapes(const PlateSystem& system) {
  const Grid& grid = system.outline.grid();
  Field shapes(grid.node_count(), 3);
  for (int j = 0; j < grid.rows; ++j) {
    const double y = static_cast<double>(j) / (grid.rows - 1);
    for (int i = 0; i < grid.columns; ++i) {
      const double x = static_cast<double>(i) / (grid.columns - 1);
      const double bump = x * (1 - x) * y * (1 - y);
      // A little off the middle, so that no shape is orthogonal to a vibration that it should find.
      shapes.row(grid.node(i, j)) << bump, bump * (x - 0.49), bump * (y - 0.51);
    }
  }
  return interior_of(system.outline, shapes);
}

// Irregular numbers between -1 and 1, so that each slow vibration has a part in them once they were
// smoothed by a solve.
Field irregular_shapes(Eigen::Index count) {
  constexpr double golden = 0.618033988749895;
  Field shapes(count, 3);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double one = golden * static_cast<double>(k + 1), other = 7 * one;
    shapes.row(k) << 1, 2 * (one - std::floor(one)) - 1, 2 * (other - std::floor(other)) - 1;
  }
  return shapes;
}

// The slowest vibration of a plate that nothing holds: first with a shift of about its size, then,
// if that was far off, with one of its own size, of which less is lost to rounding.
Result<double> find_unheld(const std::function<Result<double>(double shift)>& find, double shift) {
  constexpr double far = 30;
  auto rough = find(shift);
  if (!rough || *rough == 0 || (*rough < far * shift && shift < far * *rough)) return rough;
  return find(*rough);
}

// The motions of a rectangle that bend nothing: 1, u and v, as far as its edges allow them. A mask
// has a rim. On all nodes, a column each.
Eigen::MatrixXd unbent_motions(const Outline& outline) {
  const Grid& grid = outline.grid();
  const Edges& edges = outline.edges();
  int pinned = 0;
  const bool is_masked = !outline.mask().empty() && !outline.has_held_nodes();
  bool is_clamped = is_masked && !outline.is_unheld();
  Eigen::RowVector2d hinge(0, 0);  // where a line of u or v is 0: at the pinned edge
  const auto look = [&](Edge edge, int direction, double place) {
    is_clamped = is_clamped || edge == Edge::Clamped;
    if (edge != Edge::Pinned) return;
    ++pinned;
    hinge(direction) = place;
  };
  if (!grid.is_closed_u) {
    look(edges.u0, 0, 0);
    look(edges.u1, 0, grid.columns - 1);
  }
  if (!grid.is_closed_v) {
    look(edges.v0, 1, 0);
    look(edges.v1, 1, grid.rows - 1);
  }
  if (is_clamped || pinned > 1) return {};
  Field nodes(grid.node_count(), 3);
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i)
      nodes.row(grid.node(i, j)) << 1, i - hinge(0), j - hinge(1);
  }
  const auto is_pinned = [](Edge a, Edge b) { return a == Edge::Pinned || b == Edge::Pinned; };
  std::vector<int> columns;
  if (pinned == 0) columns.push_back(0);
  if (!grid.is_closed_u && (pinned == 0 || is_pinned(edges.u0, edges.u1))) columns.push_back(1);
  if (!grid.is_closed_v && (pinned == 0 || is_pinned(edges.v0, edges.v1))) columns.push_back(2);
  return nodes(Eigen::all, columns);
}

// Combines motions to those that are 0 at a node: one less, unless all are. The numbers are whole,
// and so small that none is rounded.
void stop_at(Eigen::Index node, Eigen::MatrixXd& motions) {
  Eigen::Index pivot = -1;
  for (Eigen::Index k = 0; k < motions.cols(); ++k) {
    const double own = std::abs(motions(node, k));
    if (own > 0 && (pivot < 0 || own < std::abs(motions(node, pivot)))) pivot = k;
  }
  if (pivot < 0) return;
  const Eigen::VectorXd moving = motions.col(pivot);
  Eigen::MatrixXd left(motions.rows(), motions.cols() - 1);
  for (Eigen::Index k = 0; k < left.cols(); ++k) {
    const Eigen::Index from = k < pivot ? k : k + 1;
    left.col(k) = moving(node) * motions.col(from) - motions(node, from) * moving;
  }
  motions = std::move(left);
}

// Those of them that no held node and no goal resists, on the unknowns.
Eigen::MatrixXd rigid_motions(const PlateSystem& system) {
  const Outline& outline = system.outline;
  const Grid& grid = outline.grid();
  Eigen::MatrixXd motions = unbent_motions(outline);
  const bool has_goal = system.goal > 0;
  for (int j = 0; (has_goal || outline.has_held_nodes()) && j < grid.rows; ++j) {
    for (int i = 0; motions.cols() > 0 && i < grid.columns; ++i) {
      const int node = grid.node(i, j);
      const bool is_resisted =
          outline.holds(i, j)
              ? has_goal && !(system.factors && factor_at(system.factors->goal, node) == 0)
              : outline.has_held_nodes();
      if (is_resisted) stop_at(node, motions);
    }
  }
  if (motions.cols() == 0) return Eigen::MatrixXd(unknown_count(outline), 0);
  Eigen::MatrixXd moving(unknown_count(outline), motions.cols());
  const std::vector<int> numbers = numbers_of_unknowns(outline);
  for (Eigen::Index node = 0; node < motions.rows(); ++node) {
    const int number = numbers[static_cast<std::size_t>(node)];
    if (number >= 0) moving.row(number) = motions.row(node);
  }
  return moving;
}

}  // namespace

bool is_held(const PlateSystem& system) { return rigid_motions(system).cols() == 0; }

Result<VibratingPlate> vibrating(PlateSolver& solver, const PlateSystem& system) {
  PLIANT_EXPECTS(system.shift >= 0 && unknown_count(system.outline) >= 1);
  if (auto ready = solver.prepare(system); !ready) return fail(ready.error());
  const Eigen::Index count = unknown_count(system.outline);
  const bool is_clamped = system.is_even() && system.shift == 0 && !system.outline.has_held_nodes();
  VibratingPlate plate{.solve = [&solver](const Field& forces) { return solver.solve(forces); },
                       .masses = node_masses(system),
                       .shapes = is_clamped ? starting_shapes(system) : irregular_shapes(count),
                       .context = solver.context(),
                       .shift = system.shift};
  if (system.shift > 0) {
    plate.rigid = rigid_motions(system);
    return plate;
  }
  // By a factor, which a shift below 0 does not matter to.
  plate.shifted = [moved = system, direct = std::shared_ptr<PlateSolver>(),
                   context =
                       solver.context()](double shift) mutable -> Result<VibratingPlate::Solve> {
    if (!direct) direct = make_plate_solver(available_solvers().front(), context);
    moved.shift = shift;
    if (auto ready = direct->prepare(moved); !ready) return fail(ready.error());
    return [direct](const Field& forces) { return direct->solve(forces); };
  };
  return plate;
}

Result<VibratingPlate> vibrating(TrianglePlate& plate, const Bending& bending, double shift,
                                 double goal) {
  PLIANT_EXPECTS(!plate.masses().empty());
  if (auto ready = plate.prepare(bending, shift, goal); !ready) return fail(ready.error());
  const auto count = static_cast<Eigen::Index>(plate.masses().size());
  const VibratingPlate::Solve solve = [&plate](const Field& forces) { return plate.solve(forces); };
  VibratingPlate vibrating{.solve = solve,
                           .masses = plate.weighted_masses(),
                           .shapes = irregular_shapes(count),
                           .context = plate.context(),
                           .shift = shift};
  vibrating.rough = [&plate](const Field& forces) {
    return plate.solve(forces, TrianglePlate::Accuracy::Rough);
  };
  if (shift > 0) return vibrating;
  vibrating.matrix = [&plate, bending, goal] { return plate.stiffness(bending, goal); };
  vibrating.solver = plate.solver();
  vibrating.shifted = [&plate, bending, goal,
                       solve](double other) -> Result<VibratingPlate::Solve> {
    if (auto ready = plate.prepare(bending, other, goal); !ready) return fail(ready.error());
    return solve;
  };
  return vibrating;
}

Result<double> smallest_eigenvalue(PlateSolver& solver, PlateSystem system) {
  const auto find = [&](double shift) -> Result<double> {
    system.shift = shift;
    const auto plate = vibrating(solver, system);
    if (!plate) return fail(plate.error());
    return smallest_eigenvalue(*plate);
  };
  const Eigen::Index rigid = rigid_motions(system).cols();
  if (rigid == 0) return find(0);
  if (rigid == unknown_count(system.outline)) return 0.0;
  // As slow as a beam of the longer side.
  const auto& [columns, rows, hu, hv, is_closed_u, is_closed_v] = system.outline.grid();
  const auto slow = [](double stiffness, double length) {
    const double square = length * length;
    return 100 * stiffness / (square * square);
  };
  return find_unheld(
      find, std::min(slow(system.stiffness.b, columns * hu), slow(system.stiffness.d, rows * hv)));
}

Result<double> smallest_eigenvalue(TrianglePlate& plate, const Bending& bending, bool is_held,
                                   double goal) {
  const auto find = [&](double shift) -> Result<double> {
    const auto vibrates = vibrating(plate, bending, shift, goal);
    if (!vibrates) return fail(vibrates.error());
    return smallest_eigenvalue(*vibrates);
  };
  if (is_held) return find(0);
  // As slow as a square.
  double area = 0;
  for (const double mass : plate.masses()) area += mass;
  return find_unheld(find, 100 * std::min(bending.uu, bending.vv) / (area * area));
}

Result<std::vector<ExcitedMode>> excited_modes(const VibratingPlate& plate,
                                               const Eigen::VectorXd& shape, Eigen::Index node) {
  PLIANT_EXPECTS(shape.size() == plate.masses.size() && shape(node) != 0);
  // Lengths and angles are those of M.
  const auto dot = [&](const auto& a, const auto& b) -> double {
    return a.dot(plate.masses.cwiseProduct(b));
  };
  // Q^T M inverse(K) M Q = T is tridiagonal; the first column of Q is the shape's direction. Each
  // new direction is orthogonalised twice against all before it, so that rounding does not bring
  // one back.
  const Eigen::Index size = std::min(most_excited, shape.size());
  Eigen::MatrixXd basis(shape.size(), size);
  Eigen::MatrixXd projected = Eigen::MatrixXd::Zero(size, size);
  const double length = std::sqrt(dot(shape, shape));
  basis.col(0) = shape / length;
  Eigen::Index count = 1;
  for (;; ++count) {
    if (plate.context.is_stopped()) return interrupted();
    Field right_hand_side = Field::Zero(shape.size(), 3);
    right_hand_side.col(0) = plate.masses.cwiseProduct(basis.col(count - 1));
    auto solved = plate.solve_roughly(right_hand_side);
    if (!solved) return fail(solved.error());
    Eigen::VectorXd next = solved->col(0);
    projected(count - 1, count - 1) = dot(basis.col(count - 1), next);
    const auto known = basis.leftCols(count);
    for (int pass = 0; pass < 2; ++pass)
      next -= known * (known.transpose() * plate.masses.cwiseProduct(next)).eval();
    const double rest = std::sqrt(dot(next, next));
    // The shape is a sum of a few modes, and all are found.
    if (count == size || rest <= 1e-12 * projected(0, 0)) break;
    projected(count, count - 1) = projected(count - 1, count) = rest;
    basis.col(count) = next / rest;
  }
  return excited_modes(projected.topLeftCorner(count, count), basis.row(node).head(count));
}

std::vector<ExcitedMode> excited_modes(const Eigen::MatrixXd& projected,
                                       const Eigen::RowVectorXd& at_node) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(projected);
  std::vector<ExcitedMode> excited;
  for (Eigen::Index k = at_node.size() - 1; k >= 0; --k) {
    const double inverse = modes.eigenvalues()(k);
    if (!(inverse > 0)) continue;  // rounding error of a very fast mode
    const auto mode = modes.eigenvectors().col(k);
    excited.push_back({1 / inverse, at_node.dot(mode) * mode(0) / at_node(0)});
  }
  return excited;
}

}  // namespace pliant
