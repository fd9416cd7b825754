#include "pliant/plate/response_space.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Eigenvalues>

#include "pliant/core/expects.hpp"
#include "pliant/plate/step_loop.hpp"

namespace pliant {

ResponseSpace::ResponseSpace(VibratingPlate plate, const Eigen::MatrixXd& patterns)
    : plate_(std::move(plate)), patterns_(patterns), roots_(plate_.masses.cwiseSqrt()) {
  PLIANT_EXPECTS(plate_.shift == 0 && patterns.rows() == roots_.size() && patterns.cols() >= 1 &&
                 patterns.cols() <= 3);
}

Result<Eigen::MatrixXd> ResponseSpace::solved(const Eigen::MatrixXd& forces) const {
  if (plate_.context.is_stopped()) return interrupted();
  Field all = Field::Zero(forces.rows(), 3);
  all.leftCols(forces.cols()) = forces;
  const auto found = plate_.solve_roughly(all);
  if (!found) return fail(found.error());
  return Eigen::MatrixXd(roots_.asDiagonal() * found->leftCols(forces.cols()));
}

// What a block has beyond the shapes, made orthonormal; `parts` are what its columns have of that.
// What is rounding beside `whole` is nothing.
Eigen::MatrixXd ResponseSpace::orthonormal(const Eigen::MatrixXd& block, double whole,
                                           Eigen::MatrixXd& parts) const {
  Eigen::MatrixXd found(block.rows(), block.cols());
  parts.setZero(block.cols(), block.cols());
  Eigen::Index count = 0;
  for (Eigen::Index k = 0; k < block.cols(); ++k) {
    auto column = found.col(count);
    column = block.col(k);
    column -= shapes_ * (shapes_.transpose() * column).eval();
    for (Eigen::Index n = 0; n < count; ++n) {
      parts(n, k) = found.col(n).dot(column);
      column -= parts(n, k) * found.col(n);
    }
    const double rest = column.norm();
    if (!(rest > 1e-12 * whole)) continue;
    column /= rest;
    parts(count++, k) = rest;
  }
  parts.conservativeResize(count, Eigen::NoChange);
  found.conservativeResize(Eigen::NoChange, count);
  return found;
}

Result<void> ResponseSpace::start() {
  if (at_rest_.size() > 0) return {};
  const auto at_rest = solved(patterns_);
  if (!at_rest) return fail(at_rest.error());
  shapes_.resize(roots_.size(), 0);
  next_ = orthonormal(*at_rest, at_rest->norm(), at_rest_);
  return {};
}

// Takes the next shapes to the others, and finds what the inverse makes of them beyond.
Result<void> ResponseSpace::extend() {
  auto block = solved(roots_.asDiagonal() * next_);
  if (!block) return fail(block.error());
  const double whole = block->norm();
  const Eigen::Index before = shapes_.cols(), added = next_.cols();
  shapes_.conservativeResize(Eigen::NoChange, before + added);
  shapes_.rightCols(added) = next_;
  const Eigen::MatrixXd parts = shapes_.transpose() * *block;
  projected_.conservativeResize(shapes_.cols(), shapes_.cols());
  projected_.rightCols(added) = parts;
  projected_.bottomRows(added) = parts.transpose();
  block->noalias() -= shapes_ * parts;  // and once more below, so that rounding brings none back
  Eigen::MatrixXd beyond;
  next_ = orthonormal(*block, whole, beyond);
  return {};
}

// Of the first shapes, so many. In their own vibrations every step is one of numbers: with the
// eigenvalue 1/theta, the equation of a step times theta, which is right for what is at rest too.
Result<std::vector<ResponseSpace::Parts>> ResponseSpace::parts_after(
    std::span<const LoadedFrame> frames, Eigen::Index count) const {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(
      projected_.topLeftCorner(count, count));
  const Eigen::ArrayXd theta = modes.eigenvalues().array().max(0);
  Eigen::MatrixXd of_patterns = Eigen::MatrixXd::Zero(count, patterns_.cols());
  of_patterns.topRows(at_rest_.rows()) = at_rest_;
  of_patterns = (modes.eigenvectors().transpose() * of_patterns).eval();
  Motion motion{Field::Zero(count, 3), Field::Zero(count, 3)};
  std::vector<Parts> found;
  for (const LoadedFrame& frame : frames) {
    const double dt = frame.steps.solved_length();
    const double shift = frame.dynamics.shift(dt), inertia = frame.dynamics.inertia(dt);
    const Field known = of_patterns * frame.load;
    const auto solve = [&](const Field& w, const Field& v) -> Result<Field> {
      const Field pushed = known + theta.matrix().asDiagonal() * (shift * w + inertia * v);
      return Field((1 + shift * theta).inverse().matrix().asDiagonal() * pushed);
    };
    if (auto done = run_steps(plate_.context, frame.steps, motion, solve); !done)
      return fail(done.error());
    found.push_back(modes.eigenvectors() * motion.displacement);
  }
  return found;
}

// Whether two answers differ by little. The first one may have fewer shapes.
bool ResponseSpace::agree(std::span<const Parts> fewer, std::span<const Parts> all) {
  constexpr double wanted = 1e-4;
  double most = 0, change = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    Parts difference = all[k];
    difference.topRows(fewer[k].rows()) -= fewer[k];
    most = std::max(most, all[k].norm());
    change = std::max(change, difference.norm());
  }
  return change <= wanted * most;
}

Result<std::optional<std::vector<ResponseSpace::Parts>>> ResponseSpace::play(
    std::span<const LoadedFrame> frames, Eigen::Index most_shapes) {
  constexpr int blocks_at_once = 6;
  if (auto started = start(); !started) return fail(started.error());
  while (true) {
    const bool are_all = next_.cols() == 0;
    const Eigen::Index fewer = shapes_.cols() - blocks_at_once * patterns_.cols();
    if (are_all || fewer >= at_rest_.rows()) {
      auto found = parts_after(frames, shapes_.cols());
      if (!found || are_all) return found;
      const auto before = parts_after(frames, fewer);
      if (!before) return fail(before.error());
      if (agree(*before, *found)) return found;
    }
    if (shapes_.cols() >= most_shapes) return std::optional<std::vector<Parts>>();
    for (int k = 0; k < blocks_at_once && next_.cols() > 0; ++k) {
      if (auto extended = extend(); !extended) return fail(extended.error());
    }
  }
}

Result<std::vector<ExcitedMode>> ResponseSpace::excited_modes(Eigen::Index node) {
  PLIANT_EXPECTS(patterns_.cols() == 1);
  if (auto started = start(); !started) return fail(started.error());
  while (shapes_.cols() < most_excited && next_.cols() > 0) {
    if (auto extended = extend(); !extended) return fail(extended.error());
  }
  const Eigen::Index count = std::min(shapes_.cols(), most_excited);
  return pliant::excited_modes(projected_.topLeftCorner(count, count),
                               shapes_.row(node).head(count));
}

std::vector<Field> ResponseSpace::displacements(std::span<const Parts> parts) const {
  if (parts.empty()) return {};
  const auto count = static_cast<Eigen::Index>(parts.size());
  Eigen::MatrixXd all(parts.front().rows(), 3 * count);
  for (Eigen::Index k = 0; k < count; ++k) all.middleCols(3 * k, 3) = parts[k];
  const Eigen::MatrixXd ways = shapes_.leftCols(all.rows()) * all;
  std::vector<Field> found;
  for (Eigen::Index k = 0; k < count; ++k)
    found.push_back(roots_.cwiseInverse().asDiagonal() * ways.middleCols(3 * k, 3));
  return found;
}

}  // namespace pliant
