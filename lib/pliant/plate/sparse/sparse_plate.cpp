#include "pliant/plate/sparse/sparse_plate.hpp"

#include <new>
#include <utility>
#include <vector>

#include "pliant/plate/solver_errors.hpp"

namespace pliant {
namespace {

std::vector<double> times(double factor, const Eigen::VectorXd& numbers) {
  std::vector<double> products(static_cast<std::size_t>(numbers.size()));
  for (std::size_t k = 0; k < products.size(); ++k)
    products[k] = factor * numbers[static_cast<Eigen::Index>(k)];
  return products;
}

}  // namespace

Result<void> SparsePlate::assemble(const PlateAssembly& assembly) try {
  is_factored_ = false;
  const bool had_pattern = std::exchange(has_factored_pattern_, false);
  if (auto assembled = matrix_.assemble(assembly); !assembled) return assembled;
  has_factored_pattern_ = had_pattern && matrix_.keeps_pattern();
  weights_ = assembly.weights();
  return {};
} catch (const std::bad_alloc&) {
  return fail(no_memory_for_factor(assembly.size()));
}

Result<void> SparsePlate::prepare(double shift, double drag) {
  if (is_factored_ && shift_ == shift && drag_ == drag) return {};
  is_factored_ = false;
  const Eigen::VectorXd shifts = (shift - drag) * weights_.masses + drag * weights_.drags;
  auto factored = factor_.factor(shifts, std::exchange(has_factored_pattern_, false),
                                 weights_.areas, matrix_.assembly().loses_digits(shift));
  if (!factored) return factored;
  is_factored_ = has_factored_pattern_ = true;
  shift_ = shift;
  drag_ = drag;
  return {};
}

Result<void> SparsePlate::prepare(const Dynamics& dynamics, const TimeSteps& steps) {
  if (steps.are_exact()) {
    return motion_.prepare({stiffness(), times(dynamics.density, weights_.masses),
                            times(dynamics.damping, weights_.drags)});
  }
  const double dt = steps.solved_length();
  return prepare(dynamics.shift(dt), dynamics.damping / dt);
}

StepTerms SparsePlate::terms(Field known, const Dynamics& dynamics, double dt) const {
  const double drag = dynamics.damping / dt;
  return {std::move(known), (dynamics.shift(dt) - drag) * weights_.masses + drag * weights_.drags,
          dynamics.inertia(dt) * weights_.masses};
}

Result<int> SparsePlate::advance(const Dynamics& dynamics, const TimeSteps& steps,
                                 const ForceChange& forces, Motion& motion,
                                 const StepFilter& accepts) {
  if (steps.are_exact()) {
    auto moved = motion_.advance(steps, forces, motion.displacement, motion.velocity);
    if (!moved) return fail(moved.error());
    return steps.count;
  }
  const StepTerms terms = this->terms(forces.last, dynamics, steps.solved_length());
  const Eigen::Index moving = terms.shift.size();
  Field right_hand_sides = terms.known;
  factor_.begin_steps();
  return run_steps(
      context_, steps, motion,
      [&](const Field& w, const Field& v) {
        for (int k = 0; k < 3; ++k) {
          right_hand_sides.col(k).head(moving) = terms.known.col(k).head(moving) +
                                                 terms.shift.cwiseProduct(w.col(k)) +
                                                 terms.inertia.cwiseProduct(v.col(k));
        }
        return factor_.solve_next(right_hand_sides);
      },
      accepts);
}

}  // namespace pliant
