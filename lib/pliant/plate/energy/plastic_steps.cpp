#include "pliant/plate/energy/plastic_steps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

namespace pliant {
namespace {

// Sums in a fixed order.
double dot(const Field& a, const Field& b) {
  double sums[4] = {0, 0, 0, 0};
  const double* const x = a.data();
  const double* const y = b.data();
  const Eigen::Index whole = a.size() / 4 * 4;
  for (Eigen::Index k = 0; k < whole; k += 4) {
    for (int n = 0; n < 4; ++n) sums[n] += x[k + n] * y[k + n];
  }
  for (Eigen::Index k = whole; k < a.size(); ++k) sums[0] += x[k] * y[k];
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

// One step: the displacement at which it and the plastic curvatures that it makes fit together,
// the least of a convex energy, by Newton's method.
class Settling {
 public:
  Settling(FlowingPlate& plate, const RunContext& context, double hardening, Eigen::Index moving)
      : plate_(plate), context_(context), hardening_(hardening), moving_(moving) {}

  // Its slope A - f' is solved by conjugate gradients, for which A is a good approximation: the
  // condition is (1 + H)/H at most. A x is known for all x that occur, so that A is only solved.
  Result<Field> settle(const PlasticField& from, const Field& right_hand_sides) {
    constexpr int most_rounds = 100;
    const double tolerance = 1e-10 * std::clamp(hardening_, 0.01, 1.0);
    Field product = right_hand_sides + plate_.forces_of(from);  // A x
    auto first = solve(product);
    if (!first) return first;
    Field x = *std::move(first);
    if (!plate_.flow(x, from, flowed_)) return x;
    double last = std::numeric_limits<double>::infinity();
    for (int round = 0; round < most_rounds; ++round) {
      const Field gradient = product - right_hand_sides - plate_.forces_of(flowed_);
      auto change = solve(gradient);
      if (!change) return change;
      const double size = largest(*change), peak = largest(x);
      // Rounding may let it become no smaller; or a number is not finite.
      const bool stalls = size < 1e-8 * peak && !(size < 0.5 * last);
      if (!(size > tolerance * peak) || stalls) {
        x -= *change;
        plate_.flow(x, from, flowed_);
        return x;
      }
      last = size;
      auto way = descend(gradient, *change);
      if (!way) return fail(way.error());
      go(from, right_hand_sides, *way, x, product);
    }
    return fail(ErrorCode::SolverFailed,
                fmt::format("a plastic step of {} nodes did not settle in {} rounds", moving_,
                            most_rounds));
  }

  // The plastic curvatures after `settle`.
  const PlasticField& flowed() const { return flowed_; }

 private:
  // A direction and what A makes of it.
  struct Way {
    Field x, product;
  };

  // Solves (A - f') way = -gradient roughly; `change` is A^-1 gradient.
  Result<Way> descend(const Field& gradient, const Field& change) {
    constexpr double enough = 0.02;
    constexpr int most_turns = 200;
    Way way{Field::Zero(gradient.rows(), 3), Field::Zero(gradient.rows(), 3)};
    Field rest = -gradient;
    Field direction = -change, product = rest;
    double size = dot(rest, direction);
    const double goal = enough * enough * size;
    for (int turn = 0; turn < most_turns && size > goal; ++turn) {
      const Field slope = product - plate_.slope_of(direction);
      const double curvature = dot(direction, slope);
      if (!(curvature > 0)) break;
      const double step = size / curvature;
      way.x += step * direction;
      way.product += step * product;
      rest -= step * slope;
      auto next = solve(rest);
      if (!next) return fail(next.error());
      const double left = dot(rest, *next);
      const double share = left / size;
      size = left;
      direction = *next + share * direction;
      product = rest + share * product;
    }
    return way;
  }

  // Goes the way, or less if the energy would grow again: its slope along the way is monotone.
  void go(const PlasticField& from, const Field& right_hand_sides, const Way& way, Field& x,
          Field& product) {
    const auto slope_at = [&](double part) {
      plate_.flow(x + part * way.x, from, flowed_);
      return dot(way.x,
                 product + part * way.product - right_hand_sides - plate_.forces_of(flowed_));
    };
    const double start = slope_at(0);
    double part = 1, slope = slope_at(1);
    for (int tries = 0; tries < 30 && slope > 0.5 * std::abs(start); ++tries) {
      part *= std::abs(start) / (std::abs(start) + slope);
      slope = slope_at(part);
    }
    x += part * way.x;
    product += part * way.product;
  }

  Result<Field> solve(const Field& right_hand_sides) {
    if (context_.is_stopped()) return fail(ErrorCode::Interrupted, "interrupted");
    return plate_.solve(right_hand_sides);
  }

  // Of what moves: slopes of a surface have another unit.
  double largest(const Field& field) const {
    return moving_ == 0 ? 0 : field.topRows(moving_).cwiseAbs().maxCoeff();
  }

  FlowingPlate& plate_;
  const RunContext& context_;
  double hardening_;
  Eigen::Index moving_;
  PlasticField flowed_;
};

}  // namespace

Result<void> run_plastic_steps(FlowingPlate& plate, const RunContext& context,
                               const StepTerms& terms, double hardening, const TimeSteps& steps,
                               int first, Motion& motion, PlasticField& plastic) {
  Settling settling(plate, context, hardening, motion.displacement.rows());
  TimeSteps rest = steps;
  rest.count = steps.count - first;
  Field right_hand_sides = terms.known;
  const auto solve = [&](const Field& w, const Field& v) {
    right_hand_sides = terms.known;
    for (int k = 0; k < 3; ++k) {
      right_hand_sides.col(k).head(w.rows()) +=
          terms.shift.cwiseProduct(w.col(k)) + terms.inertia.cwiseProduct(v.col(k));
    }
    return settling.settle(plastic, right_hand_sides);
  };
  const auto watch = [&](const Field&) {
    plastic =
        steps.are_reflected() ? PlasticField(2 * settling.flowed() - plastic) : settling.flowed();
    return true;
  };
  return run_steps(context, rest, motion, solve, watch);
}

}  // namespace pliant
