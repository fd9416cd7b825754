#include "pliant/plate/triangles/triangle_plate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/core/stage_timer.hpp"

namespace pliant {
namespace {

// The unknowns of a cell's corners and slopes, among those of the plate; each slope may be a sum.
struct Unknown {
  int index;
  double sign;
  int value;  // 0 to 2: a corner's displacement; 3 to 5: a side's slope
};

// The most unknowns that fit into one cell without a list in memory of its own.
template <class F>
void for_each_unknown(const TriangleCells& cells, const TriangleCell& cell, const F& f) {
  for (int k = 0; k < 3; ++k) {
    if (cell.points[k] < cells.free_points) f(Unknown{cell.points[k], 1, k});
  }
  for (int k = 0; k < 3; ++k) {
    const SideSlope& slope = cell.slopes[k];
    for (int n = 0; n < slope.count; ++n) {
      f(Unknown{cells.free_points + slope.first + n, slope.sign, 3 + k});
    }
  }
}

// How the curvature of a cell depends on its three displacements and three slopes.
std::array<Curvature, 6> curvature_by_value(const MorleyCell& cell) {
  const std::array<Curvature, 3> by_corner = cell.by_corner();
  return {by_corner[0],     by_corner[1],     by_corner[2],
          cell.by_slope[0], cell.by_slope[1], cell.by_slope[2]};
}

double dot(const Curvature& a, const Curvature& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace

TrianglePlate::TrianglePlate(TriangleCells cells, std::vector<double> masses, SolverChoice choice,
                             const RunContext& context)
    : cells_(std::move(cells)),
      masses_(std::move(masses)),
      context_(context),
      matrix_(choice, context.memory) {
  PLIANT_EXPECTS(static_cast<int>(masses_.size()) <= cells_.free_points);
}

// The upper triangle, by columns, rows ascending. Contributions are gathered by columns, in the
// order of the cells, and those of one entry are added in that order.
SparseMatrix TrianglePlate::assemble() const {
  const int size = cells_.unknown_count();
  std::vector<int> starts(static_cast<std::size_t>(size) + 1, 0);
  std::vector<Unknown> unknowns;
  const auto gather = [&](const TriangleCell& cell) {
    unknowns.clear();
    for_each_unknown(cells_, cell, [&](const Unknown& unknown) { unknowns.push_back(unknown); });
  };
  const auto for_each_pair = [&](const auto& f) {
    for (const Unknown& row : unknowns) {
      for (const Unknown& column : unknowns) {
        if (row.index <= column.index) f(row, column);
      }
    }
  };
  for (const TriangleCell& cell : cells_.cells) {
    gather(cell);
    for_each_pair([&](const Unknown&, const Unknown& column) { ++starts[column.index + 1]; });
  }
  for (int k = 0; k < size; ++k) starts[k + 1] += starts[k];
  struct Entry {
    int row;
    double value;
  };
  std::vector<Entry> entries(static_cast<std::size_t>(starts[size]));
  std::vector<int> next(starts.begin(), starts.end() - 1);
  for (const TriangleCell& each : cells_.cells) {
    gather(each);
    const MorleyCell cell(each.shape);
    const std::array<Curvature, 6> by_value = curvature_by_value(cell);
    std::array<Curvature, 6> moment_by_value;
    for (int k = 0; k < 6; ++k) moment_by_value[k] = moments(bending_, by_value[k]);
    for_each_pair([&](const Unknown& row, const Unknown& column) {
      const double value = cell.area * row.sign * column.sign *
                           dot(by_value[row.value], moment_by_value[column.value]);
      entries[next[column.index]++] = {row.index, value};
    });
  }
  SparseMatrix matrix(size, size);
  matrix.reserve(static_cast<Eigen::Index>(entries.size()) / 2);
  for (int column = 0; column < size; ++column) {
    matrix.startVec(column);
    const auto begin = entries.begin() + starts[column], end = entries.begin() + starts[column + 1];
    std::stable_sort(begin, end, [](const Entry& a, const Entry& b) { return a.row < b.row; });
    for (auto entry = begin; entry != end;) {
      const int row = entry->row;
      double sum = 0;
      for (; entry != end && entry->row == row; ++entry) sum += entry->value;
      const bool has_mass = row == column && row < static_cast<int>(masses_.size());
      matrix.insertBack(row, column) = has_mass ? sum + shift_ * masses_[row] : sum;
    }
  }
  matrix.finalize();
  return matrix;
}

Result<void> TrianglePlate::prepare(const Bending& bending, double shift) {
  if (is_factored_ && bending_ == bending && shift_ == shift) return {};
  const bool has_same_pattern = is_factored_;
  is_factored_ = false;
  bending_ = bending;
  shift_ = shift;
  auto factored =
      matrix_.factor(cells_.unknown_count(), has_same_pattern, [&] { return assemble(); });
  if (!factored) return factored;
  is_factored_ = true;
  return choose_passes();
}

// The forces on the unknowns by what is held: -K times the displacements and slopes that are given.
Field TrianglePlate::held_forces(const TriangleProblem& problem, const Field& displacement) const {
  Field forces = Field::Zero(cells_.unknown_count(), 3);
  for (const TriangleCell& each : cells_.cells) {
    bool is_held = false;
    for (int k = 0; k < 3; ++k) {
      is_held = is_held || each.points[k] >= cells_.free_points || each.slopes[k].count == 0;
    }
    if (!is_held) continue;
    const MorleyCell cell(each.shape);
    const std::array<Curvature, 6> by_value = curvature_by_value(cell);
    for (int component = 0; component < 3; ++component) {
      Curvature h = {0, 0, 0};
      const auto add = [&](int value, double amount) {
        for (int k = 0; k < 3; ++k) h[k] += amount * by_value[value][k];
      };
      std::array<double, 4> slopes;
      for (int k = 0; k < 4; ++k) slopes[k] = problem.slopes[k][component];
      for (int k = 0; k < 3; ++k) {
        if (each.points[k] >= cells_.free_points) add(k, displacement(each.points[k], component));
        if (each.slopes[k].count == 0) add(3 + k, cell.given_slope(k, slopes));
      }
      if (h == Curvature{0, 0, 0}) continue;
      const Curvature moment = moments(problem.bending, h);
      for_each_unknown(cells_, each, [&](const Unknown& unknown) {
        forces(unknown.index, component) -=
            cell.area * unknown.sign * dot(by_value[unknown.value], moment);
      });
    }
  }
  return forces;
}

Field TrianglePlate::residual(const Field& solution, const Field& right_hand_sides) const {
  using Real = long double;
  Field result(right_hand_sides.rows(), 3);
  std::vector<Real> sums(static_cast<std::size_t>(solution.rows()));
  for (int component = 0; component < 3; ++component) {
    for (std::size_t k = 0; k < sums.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      const Real mass = k < masses_.size() ? masses_[k] : 0;
      sums[k] = right_hand_sides(row, component) - shift_ * mass * solution(row, component);
    }
    for (const TriangleCell& each : cells_.cells) {
      const MorleyCell cell(each.shape);
      std::array<Real, 6> values = {};
      for_each_unknown(cells_, each, [&](const Unknown& unknown) {
        values[unknown.value] += unknown.sign * Real{solution(unknown.index, component)};
      });
      const std::array<Curvature, 6> by_value = curvature_by_value(cell);
      std::array<Real, 3> h = {};
      for (int value = 0; value < 6; ++value) {
        for (int k = 0; k < 3; ++k) h[k] += by_value[value][k] * values[value];
      }
      const std::array<Real, 3> moment = {bending_.uu * h[0] + bending_.coupling * h[1],
                                          bending_.coupling * h[0] + bending_.vv * h[1],
                                          bending_.uv * h[2]};
      for_each_unknown(cells_, each, [&](const Unknown& unknown) {
        Real product = 0;
        for (int k = 0; k < 3; ++k) product += by_value[unknown.value][k] * moment[k];
        sums[unknown.index] -= cell.area * unknown.sign * product;
      });
    }
    for (Eigen::Index row = 0; row < result.rows(); ++row) {
      result(row, component) = static_cast<double>(sums[static_cast<std::size_t>(row)]);
    }
  }
  return result;
}

// How often a solution must be corrected, from the errors of one that presses evenly on the plate.
Result<void> TrianglePlate::choose_passes() {
  constexpr int most_passes = 10;
  constexpr double largest_error = 1e-10;  // of the peak
  refinement_passes_ = 0;
  const auto points = static_cast<Eigen::Index>(masses_.size());
  const auto peak = [&](const Field& w) { return w.col(0).head(points).cwiseAbs().maxCoeff(); };
  Field pressure = Field::Zero(cells_.unknown_count(), 3);
  pressure.col(0).head(points) = Eigen::Map<const Eigen::VectorXd>(masses_.data(), points);
  auto solution = matrix_.solve(pressure);
  if (!solution) return fail(solution.error());
  double before = std::numeric_limits<double>::infinity();
  while (refinement_passes_ < most_passes) {
    auto correction = matrix_.solve(residual(*solution, pressure));
    if (!correction) return fail(correction.error());
    *solution += *correction;
    const double error = peak(*correction) / peak(*solution);
    // The corrections become as small as rounding lets them.
    if (!(error > largest_error) || !(error < 0.5 * before)) break;
    before = error;
    ++refinement_passes_;
  }
  return {};
}

Result<Field> TrianglePlate::solve_refined(const Field& right_hand_sides) {
  matrix_.count_solve();
  auto solution = matrix_.solve(right_hand_sides);
  for (int pass = 0; solution && pass < refinement_passes_; ++pass) {
    auto correction = matrix_.solve(residual(*solution, right_hand_sides));
    if (!correction) return correction;
    *solution += *correction;
  }
  return solution;
}

Result<Field> TrianglePlate::solve(const Field& forces) {
  const auto points = static_cast<Eigen::Index>(masses_.size());
  PLIANT_EXPECTS(is_factored_ && forces.rows() == points);
  Field right_hand_sides = Field::Zero(cells_.unknown_count(), 3);
  right_hand_sides.topRows(points) = forces;
  auto solution = solve_refined(right_hand_sides);
  if (!solution) return solution;
  return Field(solution->topRows(points));
}

Result<TriangleState> TrianglePlate::advance(const TriangleProblem& problem, const TimeSteps& steps,
                                             TriangleState state) {
  const auto points = static_cast<Eigen::Index>(masses_.size());
  PLIANT_EXPECTS(state.displacement.rows() == cells_.point_count &&
                 state.velocity.rows() == points && problem.load.rows() == points);
  const double dt = steps.length;
  const double inertia = problem.dynamics.inertia(dt);
  const double shift = problem.dynamics.shift(dt);
  StageTimer set_up(context_.profile, Stage::SetUp);
  if (auto ready = prepare(problem.bending, shift); !ready) return fail(ready.error());
  set_up.stop();
  const StageTimer solving(context_.profile, Stage::Solve);

  Field known = held_forces(problem, state.displacement);
  known.topRows(points) += problem.load;
  const Eigen::Map<const Eigen::VectorXd> masses(masses_.data(), points);
  Field w = state.displacement.topRows(points);
  Field v = std::move(state.velocity);
  Field right_hand_sides = known;
  for (int step = 0; step < steps.count; ++step) {
    if (context_.is_stopped()) return fail(ErrorCode::Interrupted, "interrupted");
    for (int k = 0; k < 3; ++k) {
      right_hand_sides.col(k).head(points) =
          known.col(k).head(points) + masses.cwiseProduct(shift * w.col(k) + inertia * v.col(k));
    }
    auto next = solve_refined(right_hand_sides);
    if (!next) return fail(next.error());
    v = (next->topRows(points) - w) / dt;
    w = next->topRows(points);
    if (step == steps.count - 1) {
      state.displacement.topRows(cells_.free_points) = next->topRows(cells_.free_points);
    }
  }
  state.velocity = std::move(v);
  return state;
}

}  // namespace pliant
