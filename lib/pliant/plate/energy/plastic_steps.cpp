#include "pliant/plate/energy/plastic_steps.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/core/anderson_mixing.hpp"
#include "pliant/core/expects.hpp"
#include "pliant/plate/energy/flowing_places.hpp"
#include "pliant/plate/energy/secants.hpp"
#include "pliant/plate/kernels/kernels.hpp"

namespace pliant {
namespace {

using Numbers = std::vector<double>;

// How short the last way is, as a part of the peak: conjugate gradients leave
// (sqrt(condition) - 1)/2 of it, which is 1e-9 at most, and the solve that follows less.
double shortest_way(double hardening) {
  const double h = std::max(hardening, 0.01);
  return 1e-9 * std::min(1.0, 2 / (std::sqrt((1 + h) / h) - 1));
}

bool are_all_zero(const Numbers& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double number) { return number == 0; });
}

Error not_in_equilibrium(Eigen::Index moving, int rounds) {
  return {ErrorCode::SolverFailed,
          fmt::format("a plastic step of {} nodes did not settle in {} rounds", moving, rounds)};
}

// A step finds the displacement at which it and the plastic curvatures that it makes fit together,
// the least of a convex energy. Of its gradient, A x - right-hand side - f(x), only the part on the
// places that may flow is not 0: all but the solves is done on these.
class EquilibriumSteps final : public PlasticSteps {
 public:
  EquilibriumSteps(FlowingPlate& plate, const RunContext& context, StepTerms terms,
                   double hardening, const TimeSteps& steps, std::vector<int> components,
                   const PlasticField& plastic)
      : plate_(plate),
        context_(context),
        kernels_(kernels_of_width(context.most_lanes)),
        terms_(std::move(terms)),
        shortest_way_(shortest_way(hardening)),
        nearest_(1e-10 * std::min(1.0, std::max(hardening, 0.01))),
        steps_(steps),
        components_(std::move(components)),
        secants_(kernels_, 2),
        sums_(Field::Zero(terms_.known.rows(), 3)),
        x_(sums_) {
    if (!plastic.isZero(0)) terms_.known += plate_.forces_of(plastic);
  }

  void expect(const Field& x, const Field& end, const PlasticField& plastic) override {
    constexpr double close = 0.95;
    watch_over(close, x, plastic, plate_.places_over(close, end, plastic));
    places_->begin(plastic);
    places_->take_from(x, way_);
    places_->go_to(way_, guess_);
  }

  Result<bool> step(Motion& motion, PlasticField& plastic) override {
    if (auto found = find_equilibrium(motion, plastic); !found) return fail(found.error());
    return take(motion, plastic);
  }

  Result<void> meet(int number, const PlasticContact& with, Motion& motion,
                    PlasticField& plastic) override {
    PLIANT_EXPECTS(!steps_.are_reflected());
    const Eigen::Index moving = motion.displacement.rows();
    if (auto found = find_equilibrium(motion, plastic); !found) return found;
    if (with.contact.begin(number, motion.displacement, x_.topRows(moving))) {
      const ContactPlate plate{[this](const Field& forces) -> Result<Field> {
                                 Field x = Field::Zero(forces.rows(), 3);
                                 if (auto solved = solve(forces, {}, x); !solved)
                                   return fail(solved.error());
                                 return x;
                               },
                               with.matrix, terms_, steps_.length};
      const auto balance = [&](const std::vector<double>& bounds,
                               std::vector<Vector3d>& forces) -> Result<Field> {
        auto found = find_balance(motion, plastic, with, plate, bounds, forces);
        if (!found) return fail(found.error());
        return Field(x_.topRows(moving));
      };
      if (auto settled = settle_contact(with.contact, with.problem, balance); !settled)
        return fail(settled.error());
    } else {
      with.contact.end({});
    }
    take(motion, plastic);
    return {};
  }

 private:
  // Goes on to x_, with what flowed on the way there; whether anything did.
  bool take(Motion& motion, PlasticField& plastic) {
    Field& w = motion.displacement;
    Field& v = motion.velocity;
    const bool flowed = places_ && places_->is_flowing();
    if (flowed) {
      const double part = steps_.are_reflected() ? 2 : 1;
      places_->grow(plastic, part);
      for (double& force : flowed_) force *= part;
      places_->add_to(terms_.known, flowed_);
    }
    const double dt = steps_.solved_length();
    for (const int k : components_) {
      const auto moved = x_.col(k).head(w.rows());
      if (steps_.are_reflected()) {
        v.col(k) = 2 * (moved - w.col(k)) / dt - v.col(k);
        w.col(k) = 2 * moved - w.col(k);
      } else {
        v.col(k) = (moved - w.col(k)) / dt;
        w.col(k) = moved;
      }
    }
    return flowed;
  }

  // The right-hand sides of a step, with the forces of what flows in it.
  void put_sums(const Motion& motion) {
    const Eigen::Index moving = motion.displacement.rows();
    for (const int k : components_) {
      sums_.col(k) = terms_.known.col(k);
      sums_.col(k).head(moving) += terms_.shift.cwiseProduct(motion.displacement.col(k)) +
                                   terms_.inertia.cwiseProduct(motion.velocity.col(k));
    }
    if (places_) places_->add_to(sums_, forces_);
  }

  // From what flows without contact, or with other rows, to what flows with the present ones: for
  // given flow contact is solved as that of an elastic plate, and what then flows comes closer by
  // 1/(1 + H) at least, faster by Anderson's method.
  Result<void> find_balance(const Motion& motion, const PlasticField& from,
                            const PlasticContact& with, const ContactPlate& plate,
                            const std::vector<double>& bounds, std::vector<Vector3d>& forces) {
    constexpr int most_rounds = 2000, most_astray = 4;
    const Eigen::Index moving = motion.displacement.rows();
    AndersonMixing mixing(12);
    Ahead ahead;
    int astray = 0;  // rounds in which Anderson's method was
    double shortest = std::numeric_limits<double>::infinity();
    double before = shortest;
    int since = 0;  // rounds since it was shortest
    forces_ = guess_;
    for (int round = 0; round < most_rounds; ++round) {
      if (context_.is_stopped()) return interrupted();
      put_sums(motion);
      if (auto solved = solve(sums_, {}, x_); !solved) return solved;
      with.contact.end_freely_at(x_.topRows(moving));
      const auto moved = pushed_by_contact(plate, with.problem, with.contact, bounds, forces);
      if (!moved) return fail(moved.error());
      x_ += *moved;
      if (yields_elsewhere(from)) {
        mixing.clear();
        ahead = {};
        continue;
      }
      if (!places_) return {};
      places_->take_from(x_, way_);
      reached_ = way_;
      places_->go_to(way_, flowed_);
      guess_ = flowed_;
      left_ = flowed_;
      add(kernels_, left_, -1, forces_);
      if (are_all_zero(left_)) return {};
      if (auto solved = solve_on_places(left_, way_); !solved) return solved;
      const double length = longest(way_, moving, peaks_of(x_, moving));
      since = length < 0.5 * shortest ? 0 : since + 1;
      shortest = std::min(shortest, length);
      if (!(length > nearest_) || (since > 40 && length < 1e-9)) return {};
      // Where the way has become longer it went astray.
      const bool is_astray = length > before;
      before = length;
      if (is_astray && astray < most_astray) {
        ++astray;
        mixing.clear();
      }
      if (astray < most_astray) {
        forces_ = mixing.next(forces_, flowed_);
      } else {
        go_ahead(ahead, is_astray);
      }
    }
    return fail(not_in_equilibrium(moving, most_rounds));
  }

  // Where it goes beyond what a round reached: what was reached before, and how far.
  struct Ahead {
    Numbers reached = {};
    double pace = 1;
  };

  // From reached_ on along the way from what was reached before, and to the forces of what flows
  // there: Nesterov's method, begun anew where it goes astray. A round is a step of a projected
  // gradient in the metric of A, so that it converges whatever flows. Source: O'Donoghue & Candes,
  // "Adaptive restart for accelerated gradient schemes" (2015).
  void go_ahead(Ahead& ahead, bool is_astray) {
    if (is_astray || ahead.reached.size() != reached_.size()) ahead = {reached_, 1};
    const double pace = (1 + std::sqrt(1 + 4 * ahead.pace * ahead.pace)) / 2;
    const double part = (ahead.pace - 1) / pace;
    way_ = reached_;
    add(kernels_, way_, part, reached_);
    add(kernels_, way_, -part, ahead.reached);
    ahead = {reached_, pace};
    places_->go_to(way_, forces_);
  }

  // Finds x_, and the forces by what then grows in flowed_.
  Result<void> find_equilibrium(const Motion& motion, const PlasticField& from) {
    constexpr int most_rounds = 100;
    const Eigen::Index moving = motion.displacement.rows();
    if (places_) places_->begin(from);
    forces_ = guess_;
    for (int round = 0; round < most_rounds; ++round) {
      put_sums(motion);
      if (auto solved = solve(sums_, {}, x_); !solved) return solved;
      if ((round > 0 || !places_) && !yields_elsewhere(from)) {
        if (!places_) return {};
        places_->take_from(x_, way_);
        places_->go_to(way_, flowed_);
        guess_ = flowed_;
        return {};
      }
      if (auto near = descend(moving); !near) return near;
    }
    return fail(not_in_equilibrium(moving, most_rounds));
  }

  // Whether places yield that are not among those that are watched: then they are from now on.
  bool yields_elsewhere(const PlasticField& from) {
    const std::vector<int> over = plate_.places_over(1, x_, from);
    if (over.empty() ||
        (places_ && std::includes(places_->places().begin(), places_->places().end(), over.begin(),
                                  over.end()))) {
      return false;
    }
    const std::optional<FlowingPlaces> earlier = std::exchange(places_, std::nullopt);
    constexpr double close = 0.8;  // how it moves on is not known
    watch_over(close, x_, from, earlier ? earlier->places() : std::vector<int>());
    places_->begin(from);
    forces_ = earlier ? places_->taken_over(*earlier, forces_) : places_->zero();
    return true;
  }

  // Those that are close to yielding too: they may soon.
  void watch_over(double close, const Field& x, const PlasticField& from,
                  const std::vector<int>& others) {
    const std::vector<int> over = plate_.places_over(close, x, from);
    std::vector<int> places;
    std::set_union(over.begin(), over.end(), others.begin(), others.end(),
                   std::back_inserter(places));
    places_.emplace(plate_, kernels_, std::move(places), components_, x.rows());
    secants_.clear();
    way_ = places_->zero();
  }

  // A quasi-Newton method on the places: from `forces_`, which make x_, to those at which the way
  // on is short enough.
  Result<void> descend(Eigen::Index moving) {
    constexpr int most_turns = 500;
    const Peaks peaks = peaks_of(x_, moving);
    places_->take_from(x_, way_);
    places_->go_to(way_, flowed_);
    gradient_ = forces_;
    add(kernels_, gradient_, -1, flowed_);
    double shortest = std::numeric_limits<double>::infinity();
    int since = 0;  // turns since it was shortest
    for (int turn = 0; turn < most_turns && !are_all_zero(gradient_); ++turn) {
      product_ = gradient_;
      secants_.to_solve(product_);
      if (auto solved = solve_on_places(product_, way_); !solved) return solved;
      secants_.finish(way_, product_);
      // The energy falls against the way.
      const double start = dot(kernels_, way_, gradient_);
      double part = -start / (dot(kernels_, way_, product_) - places_->look_along(way_));
      for (int tries = 1;; ++tries) {
        if (context_.is_stopped()) return interrupted();
        places_->flow_after(part, flowed_);
        left_ = product_;
        combine(1, forces_, part, left_);
        add(kernels_, left_, -1, flowed_);
        // Its slope along the way is monotone: less of the way if it grows again.
        const double slope = -dot(kernels_, way_, left_);
        if (!(slope > 0.5 * std::abs(start)) || tries == 30) break;
        part *= std::abs(start) / (std::abs(start) + slope);
      }
      places_->go();
      add(kernels_, forces_, part, product_);
      const double length = std::abs(part) * longest(way_, moving, peaks);
      // Of all of the way.
      combine(1 / part, left_, -1 / part, gradient_);
      secants_.learn(way_, product_, gradient_);
      gradient_.swap(left_);
      // Rounding may let it become no shorter; or a number is not finite.
      since = length < 0.5 * shortest ? 0 : since + 1;
      shortest = std::min(shortest, length);
      if (!(length > shortest_way_) || (since > 20 && length < 1e-8)) {
        forces_ = flowed_;
        return {};
      }
    }
    if (!are_all_zero(gradient_)) return fail(not_in_equilibrium(moving, most_turns));
    forces_ = flowed_;
    return {};
  }

  // A^-1 forces, there.
  Result<void> solve_on_places(const Numbers& forces, Numbers& x) {
    if (on_places_.rows() == 0) on_places_ = Field::Zero(x_.rows(), 3);
    solution_.resize(x_.rows(), 3);
    places_->add_to(on_places_, forces);
    auto solved = solve(on_places_, places_->runs(), solution_);
    places_->clear_in(on_places_);
    if (solved) places_->take_from(solution_, x);
    return solved;
  }

  Result<void> solve(const Field& forces, std::span<const UnknownRun> runs, Field& solution) {
    if (context_.is_stopped()) return interrupted();
    return plate_.solve(components_, forces, runs, solution);
  }

  // Of what moves, and of the slopes of a surface, which have another unit: what flows may press on
  // slopes alone.
  struct Peaks {
    double moving = 0, slopes = 0;
  };

  static Peaks peaks_of(const Field& x, Eigen::Index moving) {
    const auto peak = [](const auto& rows) {
      return rows.rows() == 0 ? 0 : rows.cwiseAbs().maxCoeff();
    };
    return {peak(x.topRows(moving)), peak(x.bottomRows(x.rows() - moving))};
  }

  // As a part of the peaks.
  double longest(const Numbers& way, Eigen::Index moving, const Peaks& peaks) const {
    const auto part = [](double length, double peak) { return length > 0 ? length / peak : 0; };
    return std::max(part(places_->longest(way, 0, moving), peaks.moving),
                    part(places_->longest(way, moving, x_.rows()), peaks.slopes));
  }

  // b <- part_a a + part_b b.
  void combine(double part_a, const Numbers& a, double part_b, Numbers& b) const {
    kernels_.combine(static_cast<long>(b.size()), part_a, a.data(), part_b, b.data());
  }

  FlowingPlate& plate_;
  const RunContext& context_;
  const PlateKernels& kernels_;
  StepTerms terms_;  // known: with the forces of the plastic curvatures
  double shortest_way_;
  double nearest_;  // how near what flows is to what it should be, with contact
  TimeSteps steps_;
  std::vector<int> components_;
  std::optional<FlowingPlaces> places_;  // those that may flow; none: nothing has flowed
  Secants secants_;
  Numbers guess_;            // the forces with which the next step begins
  Numbers forces_, flowed_;  // that make x_, and those by what grows there
  Numbers way_, product_, gradient_, left_, reached_;
  Field sums_, x_;
  Field on_places_, solution_;  // 0 but while it is solved for; its solution, on the places
};

}  // namespace

std::vector<int> components_at_work(const EdgeTangents& tangents, const Field& load,
                                    const Field& displacement, const Field& velocity,
                                    const PlasticField& plastic) {
  std::vector<int> components;
  for (int k = 0; k < 3; ++k) {
    const bool is_still = load.col(k).isZero(0) && displacement.col(k).isZero(0) &&
                          velocity.col(k).isZero(0) && plastic.col(k).isZero(0) &&
                          plastic.col(3 + k).isZero(0) && plastic.col(6 + k).isZero(0) &&
                          tangents.su0[k] == 0 && tangents.su1[k] == 0 && tangents.sv0[k] == 0 &&
                          tangents.sv1[k] == 0;
    if (!is_still) components.push_back(k);
  }
  return components;
}

std::unique_ptr<PlasticSteps> make_plastic_steps(FlowingPlate& plate, const RunContext& context,
                                                 StepTerms terms, double hardening,
                                                 const TimeSteps& steps,
                                                 std::vector<int> components,
                                                 const PlasticField& plastic) {
  return std::make_unique<EquilibriumSteps>(plate, context, std::move(terms), hardening, steps,
                                            std::move(components), plastic);
}

Result<TriedStep> try_step(PlasticSteps& steps, int number, StepContact* contact, Motion& motion,
                           PlasticField& plastic) {
  if (!contact) {
    const auto flowed = steps.step(motion, plastic);
    if (!flowed) return fail(flowed.error());
    return TriedStep{true, *flowed};
  }
  Motion next = motion;
  PlasticField grown = plastic;
  const auto flowed = steps.step(next, grown);
  if (!flowed) return fail(flowed.error());
  if (contact->begin(number, motion.displacement, next.displacement)) return TriedStep{false};
  contact->end({});
  motion = std::move(next);
  plastic = std::move(grown);
  return TriedStep{true, *flowed};
}

Result<void> run_met_steps(const MetPlate& plate, const RunContext& context, const TimeSteps& steps,
                           int first, Motion& motion, PlasticField& plastic) {
  // What one of the two makes flow the other one has to know.
  OwnedSteps tried, whole;
  for (int number = first; number < steps.count; ++number) {
    if (context.is_stopped()) return interrupted();
    if (steps.are_reflected() && number > first) {
      if (!tried.steps) {
        auto made = plate.make_tried(plastic);
        if (!made) return fail(made.error());
        tried = *std::move(made);
      }
      const auto done = try_step(*tried.steps, number, &plate.contact, motion, plastic);
      if (!done) return fail(done.error());
      if (done->stands) {
        whole.steps.reset();
        continue;
      }
    }
    if (!whole.steps) {
      auto made = plate.make_whole(plastic);
      if (!made) return fail(made.error());
      whole = *std::move(made);
    }
    const PlasticContact with{plate.contact, plate.problem, whole.matrix};
    if (auto met = whole.steps->meet(number, with, motion, plastic); !met) return met;
    tried.steps.reset();
  }
  return {};
}

}  // namespace pliant
