#include "pliant/plate/sparse/refined_factor.hpp"

#include <limits>
#include <utility>

namespace pliant {
namespace {

// The largest error of a solution, as a part of its peak.
constexpr double largest_error = 1e-10;

}  // namespace

RefinedFactor::RefinedFactor(PlateMatrix& matrix, SolverChoice choice, const RunContext& context)
    : matrix_(matrix), should_stop_(context.should_stop), factor_(choice, context) {}

Result<void> RefinedFactor::factor(const Eigen::VectorXd& shifts, bool has_same_pattern,
                                   const Eigen::VectorXd& pressure, bool corrects) {
  shifts_ = shifts;
  pressure_ = pressure;
  corrects_ = corrects;
  is_measured_ = refines_ = false;
  matrix_.close();
  return factor_.factor(matrix_.shifted(shifts), has_same_pattern);
}

// Finds the error of a solution: if it is too large, all are corrected.
Result<void> RefinedFactor::measure() {
  const SparseMatrix upper = matrix_.shifted(shifts_);
  Field forces = Field::Zero(upper.rows(), 3);
  forces.col(0).head(pressure_.size()) = pressure_;
  if (is_stopped(should_stop_)) return interrupted();
  auto solution = factor_.solve(forces);
  if (!solution) return fail(solution.error());
  if (is_stopped(should_stop_)) return interrupted();
  // The residual in plain double has an error of the size of the residual itself: it is a quick
  // measure for the error, right to a small factor.
  Field rough = Field::Zero(upper.rows(), 3);
  rough.col(0) = forces.col(0) - upper.selfadjointView<Eigen::Upper>() * solution->col(0);
  const auto first = factor_.solve(rough);
  if (!first) return fail(first.error());
  if (!corrects_ && peak(*first) < 0.5 * largest_error * peak(*solution)) {
    is_measured_ = true;
    return {};
  }
  if (auto opened = matrix_.open(); !opened) return opened;
  const Field left = matrix_.residual(shifts_, *solution, forces);
  if (is_stopped(should_stop_)) return interrupted();
  const auto correction = factor_.solve(left);
  if (!correction) return fail(correction.error());
  error_ = peak(*correction) / peak(*solution);
  is_measured_ = true;
  refines_ = corrects_ || error_ > largest_error;
  if (!refines_) matrix_.close();
  return {};
}

// Corrects a guess until what a solve leaves is small; without a guess a solution is the first one.
Result<Field> RefinedFactor::solve(const Field& right_hand_sides, std::optional<Field> guess) {
  constexpr int most_passes = 10;
  if (!is_measured_) {
    if (auto measured = measure(); !measured) return fail(measured.error());
  }
  factor_.count_solve();
  if (!refines()) return factor_.solve(right_hand_sides);
  Result<Field> solution =
      guess ? Result<Field>(*std::move(guess)) : factor_.solve(right_hand_sides);
  double before = std::numeric_limits<double>::infinity();
  for (int pass = 0; solution && pass < most_passes; ++pass) {
    if (is_stopped(should_stop_)) return interrupted();
    auto correction = factor_.solve(matrix_.residual(shifts_, *solution, right_hand_sides));
    if (!correction) return correction;
    *solution += *correction;
    const double change = peak(*correction);
    // The corrections become as small as rounding lets them.
    if (!(error_ * change > largest_error * peak(*solution)) || !(change < 0.5 * before)) break;
    before = change;
  }
  return solution;
}

Result<Field> RefinedFactor::solve_roughly(const Field& right_hand_sides) {
  factor_.count_solve();
  return factor_.solve(right_hand_sides);
}

Result<Field> RefinedFactor::solve_next(const Field& right_hand_sides) {
  auto next = solve(right_hand_sides, before_ ? Field(2 * *last_ - *before_) : last_);
  if (next && refines()) {
    before_ = std::move(last_);
    last_ = *next;
  }
  return next;
}

}  // namespace pliant
