#include "pliant/plate/energy/advance_plastic.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/core/stage_timer.hpp"
#include "pliant/plate/energy/plastic_plate.hpp"

namespace pliant {
namespace {

bool is_elastic(const PlasticField& plastic) { return plastic.isZero(0); }

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

double largest(const Field& field) { return field.size() == 0 ? 0 : field.cwiseAbs().maxCoeff(); }

// The way of a plate from step to step, on all nodes.
struct Progress {
  Field displacement, velocity;
  int steps = 0;
};

// Goes on from step to step as long as none yields.
class ElasticSteps {
 public:
  ElasticSteps(PlasticPlate& plate, const TimeSteps& steps, const PlateState& from)
      : plate_(plate),
        steps_(steps),
        plastic_(from.plastic),
        done_{from.displacement, from.velocity} {}

  // Whether the step to `next` was elastic.
  bool take(const Field& next) {
    const double dt = steps_.solved_length();
    Field& w = done_.displacement;
    Field& v = done_.velocity;
    if (plate_.yields(steps_.are_reflected() ? Field((next + w) / 2) : next, plastic_)) {
      return false;
    }
    if (steps_.are_reflected()) {
      v = (next - w) / dt - v;
    } else {
      v = (next - w) / dt;
    }
    w = next;
    ++done_.steps;
    return true;
  }

  Progress& done() { return done_; }

 private:
  PlasticPlate& plate_;
  const TimeSteps& steps_;
  const PlasticField& plastic_;
  Progress done_;
};

class PlasticSteps {
 public:
  PlasticSteps(PlateSolver& solver, PlasticPlate& plate, const PlateProblem& problem,
               const TimeSteps& steps)
      : solver_(solver), plate_(plate), problem_(problem), steps_(steps) {}

  Result<void> prepare(const Field& displacement) {
    const double dt = steps_.solved_length();
    const StageTimer set_up(solver_.context().profile, Stage::SetUp);
    if (auto ready = solver_.prepare(problem_.system(dt)); !ready) return ready;
    terms_ = solver_.terms(problem_, dt, displacement);
    return {};
  }

  // One step of displacement, velocity and plastic curvatures on all nodes.
  Result<void> step(PlateState& state) {
    const Outline& outline = problem_.outline;
    const Field w = interior_of(outline, state.displacement);
    const Field v = interior_of(outline, state.velocity);
    Field right_hand_sides = terms_.known;
    for (int k = 0; k < 3; ++k) {
      right_hand_sides.col(k) +=
          terms_.shift.cwiseProduct(w.col(k)) + terms_.inertia.cwiseProduct(v.col(k));
    }
    auto solved = settle(state, right_hand_sides);
    if (!solved) return fail(solved.error());
    const Field& next = *solved;
    const double dt = steps_.solved_length();
    if (steps_.are_reflected()) {
      set(state, 2 * next - w, 2 * (next - w) / dt - v);
      state.plastic = 2 * flowed_ - state.plastic;
    } else {
      set(state, next, (next - w) / dt);
      state.plastic = flowed_;
    }
    return {};
  }

 private:
  void set(PlateState& state, const Field& w, const Field& v) const {
    state.displacement = with_interior(problem_.outline, std::move(state.displacement), w);
    state.velocity = with_interior(problem_.outline, std::move(state.velocity), v);
  }

  // The displacement at which it and the plastic curvatures that it makes fit together: the least
  // of a convex energy, by Newton's method. With A the elastic matrix and f what has flowed does,
  // A x - f(x) = right-hand side. Its slope A - f' is solved by conjugate gradients, for which A is
  // a good approximation: the condition is (1 + H)/H at most. A x is known for all x that occur, so
  // that A is only solved.
  Result<Field> settle(const PlateState& from, const Field& right_hand_sides) {
    constexpr int most_rounds = 100;
    const double tolerance = 1e-10 * std::clamp(problem_.law->hardening, 0.01, 1.0);
    Field product = right_hand_sides + forces_of(from.plastic);  // A x
    auto first = solve(product);
    if (!first) return first;
    Field x = *std::move(first);
    if (!flow(from, x)) return x;
    double last = std::numeric_limits<double>::infinity();
    for (int round = 0; round < most_rounds; ++round) {
      const Field gradient = product - right_hand_sides - forces_of(flowed_);
      auto change = solve(gradient);
      if (!change) return change;
      const double size = largest(*change), peak = largest(x);
      // Rounding may let it become no smaller; or a number is not finite.
      const bool stalls = size < 1e-8 * peak && !(size < 0.5 * last);
      if (!(size > tolerance * peak) || stalls) {
        x -= *change;
        flow(from, x);
        return x;
      }
      last = size;
      auto way = descend(gradient, *change);
      if (!way) return fail(way.error());
      go(from, right_hand_sides, *way, x, product);
    }
    return fail(ErrorCode::SolverFailed,
                fmt::format("a plastic step of {} nodes did not settle in {} rounds",
                            problem_.outline.unknown_count(), most_rounds));
  }

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
      const Field slope = product - slope_forces(direction);
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
  void go(const PlateState& from, const Field& right_hand_sides, const Way& way, Field& x,
          Field& product) {
    const auto slope_at = [&](double part) {
      flow(from, x + part * way.x);
      return dot(way.x, product + part * way.product - right_hand_sides - forces_of(flowed_));
    };
    flow(from, x);
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
    if (solver_.context().is_stopped()) return fail(ErrorCode::Interrupted, "interrupted");
    return solver_.solve(right_hand_sides);
  }

  // What a displacement makes of the plastic curvatures.
  bool flow(const PlateState& from, const Field& x) {
    nodes_ = with_interior(problem_.outline, from.displacement, x);
    return plate_.flow(nodes_, from.plastic, flowed_);
  }

  Field forces_of(const PlasticField& plastic) {
    nodes_.setZero(plastic.rows(), 3);
    plate_.add_forces(plastic, nodes_);
    return interior_of(problem_.outline, nodes_);
  }

  Field slope_forces(const Field& way) {
    Field forces = Field::Zero(flowed_.rows(), 3);
    plate_.add_slope(with_interior(problem_.outline, forces, way), forces);
    return interior_of(problem_.outline, forces);
  }

  PlateSolver& solver_;
  PlasticPlate& plate_;
  const PlateProblem& problem_;
  const TimeSteps& steps_;
  StepTerms terms_;
  PlasticField flowed_;
  Field nodes_;
};

// The problem with the forces of the plastic curvatures in the load, and without flow.
PlateProblem held(const PlateProblem& problem, const PlasticPlate& plate,
                  const PlasticField& plastic) {
  PlateProblem elastic = problem;
  elastic.law.reset();
  if (is_elastic(plastic)) return elastic;
  Field forces = Field::Zero(problem.load.rows(), 3);
  plate.add_forces(plastic, forces);
  const PlateSystem system = problem.system(1);
  const PlateEnergy energy(system);
  problem.outline.for_each_run([&](const Outline::Run& run) {
    for (int i = run.i0; i <= run.i1; ++i) {
      const int node = problem.outline.grid().node(i, run.j);
      elastic.load.row(node) += forces.row(node) / energy.share(i, run.j);
    }
  });
  return elastic;
}

}  // namespace

Result<PlateState> advance_plastic(PlateSolver& solver, const PlateProblem& problem,
                                   const TimeSteps& steps, PlateState state) {
  PLIANT_EXPECTS(problem.law && state.plastic.rows() == problem.load.rows());
  PlasticPlate plate(problem);
  PlateProblem elastic = held(problem, plate, state.plastic);
  clear_rim(problem.outline, state.velocity);
  ElasticSteps elastic_steps(plate, steps, state);
  bool yields = false;
  const std::function<bool(const Field&)> watch = [&](const Field& displacement) {
    yields = !elastic_steps.take(displacement);
    return !yields;
  };
  elastic.watch = &watch;
  auto advanced = solver.advance(elastic, steps, {state.displacement, state.velocity, {}});
  if (!advanced) return advanced;
  if (!yields) {
    advanced->plastic = std::move(state.plastic);
    return advanced;
  }
  Progress& done = elastic_steps.done();
  state.displacement = std::move(done.displacement);
  state.velocity = std::move(done.velocity);
  elastic.watch = nullptr;
  // The forces of what has flowed are not in the load from here on.
  PlasticSteps plastic_steps(solver, plate, problem, steps);
  if (auto ready = plastic_steps.prepare(state.displacement); !ready) return fail(ready.error());
  const StageTimer solving(solver.context().profile, Stage::Solve);
  for (int step = done.steps; step < steps.count; ++step) {
    if (auto stepped = plastic_steps.step(state); !stepped) return fail(stepped.error());
  }
  return state;
}

}  // namespace pliant
