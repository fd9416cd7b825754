#include "pliant/plate/triangles/triangle_plate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/core/stage_timer.hpp"
#include "pliant/plate/solver_errors.hpp"

namespace pliant {
namespace {

// The largest error of a solution, as a part of its peak.
constexpr double largest_error = 1e-10;

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
      matrix_(choice, context),
      precise_share_(context.memory) {
  PLIANT_EXPECTS(static_cast<int>(masses_.size()) <= cells_.free_points);
  matrix_.use_supernodes(kernels_of_width(context.most_lanes));
}

// Contributions are gathered by rows, in the order of the blocks, and those of one entry are added
// in that order.
template <class Real>
TrianglePlate::Rows<Real> TrianglePlate::rows(const Bending& bending, double shift,
                                              Half half) const {
  struct Entry {
    int row, column;
    Real value;
  };
  std::vector<Entry> entries;
  CellBlock<Real> block;
  for (int k = 0; k < cells_.block_count(); ++k) {
    block.compute(cells_, k, reduced_, bending);
    for (int a = block.inner_count(); a < block.size(); ++a) {
      for (int b = a; b < block.size(); ++b) {
        const auto [low, high] =
            std::minmax(reduced_.places[block.unknown(a)], reduced_.places[block.unknown(b)]);
        entries.push_back({high, low, block.at(a, b)});
        if (half == Half::Both && low != high) entries.push_back({low, high, block.at(a, b)});
      }
    }
  }
  const int size = reduced_.count;
  std::vector<int> starts(static_cast<std::size_t>(size) + 1, 0);
  for (const Entry& entry : entries) ++starts[entry.row + 1];
  for (int k = 0; k < size; ++k) starts[k + 1] += starts[k];
  std::vector<int> order(entries.size());
  std::vector<int> next(starts.begin(), starts.end() - 1);
  for (std::size_t k = 0; k < entries.size(); ++k) {
    order[next[entries[k].row]++] = static_cast<int>(k);
  }
  Rows<Real> rows;
  rows.columns.reserve(entries.size() / 2);
  rows.values.reserve(entries.size() / 2);
  for (int row = 0; row < size; ++row) {
    const auto begin = order.begin() + starts[row], end = order.begin() + starts[row + 1];
    std::sort(begin, end, [&](int a, int b) {
      return std::pair(entries[a].column, a) < std::pair(entries[b].column, b);
    });
    for (auto place = begin; place != end;) {
      const int column = entries[*place].column;
      Real sum = 0;
      for (; place != end && entries[*place].column == column; ++place)
        sum += entries[*place].value;
      const bool has_mass = row == column && row < static_cast<int>(masses_.size());
      rows.columns.push_back(column);
      rows.values.push_back(has_mass ? sum + Real{shift} * masses_[row] : sum);
    }
    rows.starts.push_back(rows.columns.size());
  }
  return rows;
}

SparseMatrix TrianglePlate::matrix(const Bending& bending, double shift) const {
  // The rows of the lower half are the columns of the upper one.
  const Rows<double> columns = rows<double>(bending, shift, Half::Lower);
  SparseMatrix matrix(reduced_.count, reduced_.count);
  matrix.reserve(static_cast<Eigen::Index>(columns.values.size()));
  for (int column = 0; column < reduced_.count; ++column) {
    matrix.startVec(column);
    for (std::size_t k = columns.starts[column]; k < columns.starts[column + 1]; ++k)
      matrix.insertBack(columns.columns[k], column) = columns.values[k];
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
  const auto presses_on_inner = [&](int block) {
    bool presses = false;
    for (int k = cells_.block_starts[block]; k < cells_.block_starts[block + 1]; ++k) {
      for_each_unknown(cells_, cells_.cells[k], [&](const CellUnknown& unknown) {
        presses =
            presses || (reduced_.places[unknown.index] < 0 && !forces.row(unknown.index).isZero(0));
      });
    }
    return presses;
  };
  CellBlock<double> block;
  std::vector<double> own;
  for (const int k : reduced_.blocks) {
    if (!presses_on_inner(k)) continue;
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
  if (auto measured = measure_error(upper); !measured) return measured;
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
  const double* const x = solution.col(0).data();
  const double* const y = solution.col(1).data();
  const double* const z = solution.col(2).data();
  Field result(right_hand_sides.rows(), 3);
  for (Eigen::Index row = 0; row < result.rows(); ++row) {
    Extended of_x = right_hand_sides(row, 0);
    Extended of_y = right_hand_sides(row, 1);
    Extended of_z = right_hand_sides(row, 2);
    for (std::size_t k = precise_.starts[row]; k < precise_.starts[row + 1]; ++k) {
      const Extended entry = precise_.values[k];
      const int column = precise_.columns[k];
      of_x -= entry * x[column];
      of_y -= entry * y[column];
      of_z -= entry * z[column];
    }
    result(row, 0) = static_cast<double>(of_x);
    result(row, 1) = static_cast<double>(of_y);
    result(row, 2) = static_cast<double>(of_z);
  }
  return result;
}

// Of the points that have a mass.
double TrianglePlate::peak(const Field& solution) const {
  return solution.topRows(static_cast<Eigen::Index>(masses_.size())).cwiseAbs().maxCoeff();
}

void TrianglePlate::drop_precise() {
  precise_ = {};
  static_cast<void>(precise_share_.try_resize(0));  // to give back never fails
}

// Finds the error of a solution, by one that presses evenly on the plate: if it is too large, all
// are corrected.
Result<void> TrianglePlate::measure_error(const SparseMatrix& upper) {
  solve_error_ = 0;
  drop_precise();
  const auto points = static_cast<Eigen::Index>(masses_.size());
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
  if (peak(*first) < 0.5 * largest_error * peak(*solution)) return {};
  // Both halves of the matrix, and twice as much while they are gathered.
  const std::size_t bytes =
      static_cast<std::size_t>(upper.nonZeros()) * 6 * (sizeof(Extended) + 2 * sizeof(int));
  if (!precise_share_.try_resize(bytes))
    return fail(factor_too_large(reduced_.count, precise_share_.complaint(bytes)));
  precise_ = rows<Extended>(bending_, shift_, Half::Both);
  const auto correction = matrix_.solve(residual(*solution, pressure));
  if (!correction) return fail(correction.error());
  solve_error_ = peak(*correction) / peak(*solution);
  if (solve_error_ > largest_error) return {};
  solve_error_ = 0;
  drop_precise();
  return {};
}

// Corrects a guess until what a solve leaves is small. A good guess, such as the way on from the
// steps before, needs one solve, and without one a solution is the first guess.
Result<Field> TrianglePlate::solve_refined(const Field& right_hand_sides,
                                           std::optional<Field> guess) {
  constexpr int most_passes = 10;
  matrix_.count_solve();
  if (!refines()) return matrix_.solve(right_hand_sides);
  Result<Field> solution =
      guess ? Result<Field>(*std::move(guess)) : matrix_.solve(right_hand_sides);
  double before = std::numeric_limits<double>::infinity();
  for (int pass = 0; solution && pass < most_passes; ++pass) {
    auto correction = matrix_.solve(residual(*solution, right_hand_sides));
    if (!correction) return correction;
    *solution += *correction;
    const double change = peak(*correction);
    // The corrections become as small as rounding lets them.
    if (!(solve_error_ * change > largest_error * peak(*solution)) || !(change < 0.5 * before))
      break;
    before = change;
  }
  return solution;
}

Result<Field> TrianglePlate::solve(const Field& forces) {
  const auto points = static_cast<Eigen::Index>(masses_.size());
  PLIANT_EXPECTS(is_factored_ && forces.rows() == points);
  Field right_hand_sides = Field::Zero(reduced_.count, 3);
  right_hand_sides.topRows(points) = forces;
  auto solution = solve_refined(right_hand_sides, {});
  if (!solution) return solution;
  return Field(solution->topRows(points));
}

Result<TriangleState> TrianglePlate::advance(const TriangleProblem& problem, const TimeSteps& steps,
                                             TriangleState state) {
  const auto points = static_cast<Eigen::Index>(masses_.size());
  PLIANT_EXPECTS(state.displacement.rows() == cells_.point_count &&
                 state.velocity.rows() == points && problem.load.rows() == points);
  const double dt = steps.solved_length();
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
  // The solutions of the last two steps, if they are refined.
  std::optional<Field> last, before;
  for (int step = 0; step < steps.count; ++step) {
    if (context_.is_stopped()) return fail(ErrorCode::Interrupted, "interrupted");
    for (int k = 0; k < 3; ++k) {
      right_hand_sides.col(k).head(points) =
          known.col(k).head(points) + masses.cwiseProduct(shift * w.col(k) + inertia * v.col(k));
    }
    auto next = solve_refined(right_hand_sides, before ? Field(2 * *last - *before) : last);
    if (!next) return fail(next.error());
    if (refines()) {
      before = std::move(last);
      last = *next;
    }
    const auto moved = next->topRows(points);
    if (steps.are_reflected()) {
      v = 2 * (moved - w) / dt - v;
      w = 2 * moved - w;
    } else {
      v = (moved - w) / dt;
      w = moved;
    }
  }
  state.displacement.topRows(points) = w;
  state.velocity = std::move(v);
  return state;
}

}  // namespace pliant
