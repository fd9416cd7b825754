#include "pliant/plate/triangles/triangle_plate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/core/stage_timer.hpp"

namespace pliant {
namespace {

double dot(const Curvature& a, const Curvature& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace

TrianglePlate::TrianglePlate(TriangleCells cells, std::vector<double> masses, SolverChoice choice,
                             const RunContext& context)
    : cells_(std::move(cells)),
      masses_(std::move(masses)),
      context_(context),
      reduced_(cells_, static_cast<int>(masses_.size())),
      matrix_(choice, context.memory) {
  PLIANT_EXPECTS(static_cast<int>(masses_.size()) <= cells_.free_points);
}

// The upper triangle, by columns, rows ascending. Contributions are gathered by columns, in the
// order of the blocks, and those of one entry are added in that order.
SparseMatrix TrianglePlate::matrix(const Bending& bending, double shift) const {
  struct Entry {
    int row, column;
    double value;
  };
  std::vector<Entry> entries;
  CellBlock<double> block;
  for (int k = 0; k < cells_.block_count(); ++k) {
    block.compute(cells_, k, reduced_, bending);
    for (int a = block.inner_count(); a < block.size(); ++a) {
      for (int b = a; b < block.size(); ++b) {
        const auto [row, column] =
            std::minmax(reduced_.places[block.unknown(a)], reduced_.places[block.unknown(b)]);
        entries.push_back({row, column, block.at(a, b)});
      }
    }
  }
  const int size = reduced_.count;
  std::vector<int> starts(static_cast<std::size_t>(size) + 1, 0);
  for (const Entry& entry : entries) ++starts[entry.column + 1];
  for (int k = 0; k < size; ++k) starts[k + 1] += starts[k];
  std::vector<int> order(entries.size());
  std::vector<int> next(starts.begin(), starts.end() - 1);
  for (std::size_t k = 0; k < entries.size(); ++k) {
    order[next[entries[k].column]++] = static_cast<int>(k);
  }
  SparseMatrix matrix(size, size);
  matrix.reserve(static_cast<Eigen::Index>(entries.size()) / 2);
  for (int column = 0; column < size; ++column) {
    matrix.startVec(column);
    const auto begin = order.begin() + starts[column], end = order.begin() + starts[column + 1];
    std::sort(begin, end, [&](int a, int b) {
      return std::pair(entries[a].row, a) < std::pair(entries[b].row, b);
    });
    for (auto place = begin; place != end;) {
      const int row = entries[*place].row;
      double sum = 0;
      for (; place != end && entries[*place].row == row; ++place) sum += entries[*place].value;
      const bool has_mass = row == column && row < static_cast<int>(masses_.size());
      matrix.insertBack(row, column) = has_mass ? sum + shift * masses_[row] : sum;
    }
  }
  matrix.finalize();
  return matrix;
}

// Eliminates the inner unknowns from forces on all unknowns.
Field TrianglePlate::reduced(const Field& forces) const {
  Field result(reduced_.count, 3);
  for (Eigen::Index unknown = 0; unknown < forces.rows(); ++unknown) {
    const int place = reduced_.places[unknown];
    if (place >= 0) result.row(place) = forces.row(unknown);
  }
  CellBlock<double> block;
  std::vector<double> own;
  for (const int k : reduced_.blocks) {
    block.compute(cells_, k, reduced_, bending_);
    for (int component = 0; component < 3; ++component) {
      own.assign(static_cast<std::size_t>(block.size()), 0);
      for (int n = 0; n < block.inner_count(); ++n) own[n] = forces(block.unknown(n), component);
      block.reduce(own);
      for (int n = block.inner_count(); n < block.size(); ++n) {
        result(reduced_.places[block.unknown(n)], component) += own[n];
      }
    }
  }
  return result;
}

Result<void> TrianglePlate::prepare(const Bending& bending, double shift) {
  if (is_factored_ && bending_ == bending && shift_ == shift) return {};
  const bool has_same_pattern = is_factored_;
  is_factored_ = false;
  bending_ = bending;
  shift_ = shift;
  SparseMatrix upper;
  auto factored = matrix_.factor(reduced_.count, has_same_pattern,
                                 [&] { return upper = matrix(bending_, shift_); });
  if (!factored) return factored;
  if (auto chosen = choose_passes(upper); !chosen) return chosen;
  is_factored_ = true;
  return {};
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
    const std::array<Curvature, 6> by_value = cell.by_value();
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
      for_each_unknown(cells_, each, [&](const CellUnknown& unknown) {
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
  std::vector<std::array<Real, 3>> sums(static_cast<std::size_t>(solution.rows()));
  for (std::size_t k = 0; k < sums.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const Real mass = k < masses_.size() ? masses_[k] : 0;
    for (int n = 0; n < 3; ++n) {
      sums[k][n] = right_hand_sides(row, n) - shift_ * mass * solution(row, n);
    }
  }
  CellBlock<Real> block;
  for (int k = 0; k < cells_.block_count(); ++k) {
    block.compute(cells_, k, reduced_, bending_);
    for (int a = block.inner_count(); a < block.size(); ++a) {
      const int row = reduced_.places[block.unknown(a)];
      for (int b = block.inner_count(); b < block.size(); ++b) {
        const int column = reduced_.places[block.unknown(b)];
        const Real entry = a < b ? block.at(a, b) : block.at(b, a);
        for (int n = 0; n < 3; ++n) sums[row][n] -= entry * solution(column, n);
      }
    }
  }
  for (std::size_t k = 0; k < sums.size(); ++k) {
    for (int n = 0; n < 3; ++n) {
      result(static_cast<Eigen::Index>(k), n) = static_cast<double>(sums[k][n]);
    }
  }
  return result;
}

// How often a solution must be corrected, from the errors of one that presses evenly on the plate.
Result<void> TrianglePlate::choose_passes(const SparseMatrix& upper) {
  constexpr int most_passes = 10;
  constexpr double largest_error = 1e-10;  // of the peak
  refinement_passes_ = 0;
  const auto points = static_cast<Eigen::Index>(masses_.size());
  const auto peak = [&](const Field& w) { return w.col(0).head(points).cwiseAbs().maxCoeff(); };
  Field pressure = Field::Zero(reduced_.count, 3);
  pressure.col(0).head(points) = Eigen::Map<const Eigen::VectorXd>(masses_.data(), points);
  auto solution = matrix_.solve(pressure);
  if (!solution) return fail(solution.error());
  // The residual in plain double has an error of the size of the residual itself: it is a quick
  // measure for the error, right to a small factor.
  Field rough = Field::Zero(reduced_.count, 3);
  rough.col(0) = pressure.col(0) - upper.selfadjointView<Eigen::Upper>() * solution->col(0);
  const auto first = matrix_.solve(rough);
  if (!first) return fail(first.error());
  if (peak(*first) < 0.1 * largest_error * peak(*solution)) return {};
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
  Field right_hand_sides = Field::Zero(reduced_.count, 3);
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

  Field known = reduced(held_forces(problem, state.displacement));
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
  }
  state.displacement.topRows(points) = w;
  state.velocity = std::move(v);
  return state;
}

}  // namespace pliant
