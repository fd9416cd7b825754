#include "pliant/plate/energy/plastic_steps.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "pliant/plate/energy/flowing_places.hpp"
#include "pliant/plate/energy/secants.hpp"

namespace pliant {
namespace {

using Numbers = Secants::Numbers;

// How short the last way is, as a part of the peak: conjugate gradients leave
// (sqrt(condition) - 1)/2 of it, which is 1e-9 at most, and the solve that follows less.
double shortest_way(double hardening) {
  const double h = std::max(hardening, 0.01);
  return 1e-9 * std::min(1.0, 2 / (std::sqrt((1 + h) / h) + 1));
}

Numbers sum(Numbers a, double part, const Numbers& b) {
  add_scaled(a, part, b);
  return a;
}

Numbers difference(Numbers a, const Numbers& b) {
  add_scaled(a, -1, b);
  return a;
}

bool are_all_zero(const Numbers& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double number) { return number == 0; });
}

Error not_settled(Eigen::Index moving, int rounds) {
  return {ErrorCode::SolverFailed,
          fmt::format("a plastic step of {} nodes did not settle in {} rounds", moving, rounds)};
}

// A step finds the displacement at which it and the plastic curvatures that it makes fit together,
// the least of a convex energy. Of its gradient, A x - right-hand side - f(x), only the part on the
// places that may flow is not 0: all but the solves is done on these. N components are at work.
template <std::size_t N>
class SettlingSteps final : public PlasticSteps {
 public:
  SettlingSteps(FlowingPlate& plate, const RunContext& context, StepTerms terms, double hardening,
                const TimeSteps& steps, std::array<int, 3> components, const PlasticField& plastic)
      : plate_(plate),
        context_(context),
        terms_(std::move(terms)),
        shortest_way_(shortest_way(hardening)),
        steps_(steps),
        components_(components) {
    if (!plastic.isZero(0)) terms_.known += plate_.forces_of(plastic);
  }

  void expect(const Field& x, const PlasticField& plastic) override {
    watch_over(x, plastic, {});
    places_->begin(plastic);
    places_->go_to(places_->taken_from(x));
    growth_ = places_->growth();
  }

  Result<bool> step(Motion& motion, PlasticField& plastic) override {
    const Field& w = motion.displacement;
    const Field& v = motion.velocity;
    Field right_hand_sides = terms_.known;
    for (int k = 0; k < 3; ++k) {
      right_hand_sides.col(k).head(w.rows()) +=
          terms_.shift.cwiseProduct(w.col(k)) + terms_.inertia.cwiseProduct(v.col(k));
    }
    auto x = settle(right_hand_sides, w.rows(), plastic);
    if (!x) return fail(x.error());
    const bool flowed = places_ && places_->is_flowing();
    if (flowed) {
      const double part = steps_.are_reflected() ? 2 : 1;
      places_->grow(plastic, part);
      Numbers forces = places_->forces_of(places_->growth());
      for (double& force : forces) force *= part;
      places_->add_to(terms_.known, forces);
    }
    const double dt = steps_.solved_length();
    const auto moved = x->topRows(w.rows());
    if (steps_.are_reflected()) {
      motion.velocity = 2 * (moved - w) / dt - v;
      motion.displacement = 2 * moved - w;
    } else {
      motion.velocity = (moved - w) / dt;
      motion.displacement = moved;
    }
    return flowed;
  }

 private:
  using Growth = typename FlowingPlaces<N>::Growth;

  Result<Field> settle(const Field& right_hand_sides, Eigen::Index moving,
                       const PlasticField& from) {
    constexpr int most_rounds = 100;
    Numbers forces;  // by what grows
    if (places_) {
      places_->begin(from);
      forces = places_->forces_of(growth_);
    }
    for (int round = 0; round < most_rounds; ++round) {
      Field all = right_hand_sides;
      if (places_) places_->add_to(all, forces);
      auto x = solve(all);
      if (!x) return x;
      const bool is_near = round > 0;
      if ((is_near || !places_) && !yields_elsewhere(*x, from, forces)) {
        if (!places_) return x;
        places_->go_to(places_->taken_from(*x));
        growth_ = places_->growth();
        return x;
      }
      if (auto near = descend(*x, moving, forces); !near) return fail(near.error());
    }
    return fail(not_settled(moving, most_rounds));
  }

  // Whether places yield that are not among those that are watched: then they are from now on.
  bool yields_elsewhere(const Field& x, const PlasticField& from, Numbers& forces) {
    const std::vector<int> over = plate_.places_over(1, x, from);
    if (over.empty() ||
        (places_ && std::includes(places_->places().begin(), places_->places().end(), over.begin(),
                                  over.end()))) {
      return false;
    }
    const std::optional<FlowingPlaces<N>> earlier = std::exchange(places_, std::nullopt);
    watch_over(x, from, earlier ? earlier->places() : std::vector<int>());
    places_->begin(from);
    forces = earlier ? places_->taken_over(*earlier, forces) : places_->zero();
    growth_ = earlier ? places_->taken_over(*earlier, growth_) : places_->growth();
    return true;
  }

  // Those that are close to yielding too: they may soon.
  void watch_over(const Field& x, const PlasticField& from, const std::vector<int>& others) {
    constexpr double close = 0.8;
    const std::vector<int> over = plate_.places_over(close, x, from);
    std::vector<int> places;
    std::set_union(over.begin(), over.end(), others.begin(), others.end(),
                   std::back_inserter(places));
    places_.emplace(plate_, std::move(places), components_, x.rows());
    secants_.clear();
  }

  // A quasi-Newton method on the places: from `forces`, which make x, to those at which the way on
  // is short enough.
  Result<void> descend(const Field& x, Eigen::Index moving, Numbers& forces) {
    constexpr int most_turns = 500;
    const Peaks peaks = peaks_of(x, moving);
    Numbers flowed = places_->go_to(places_->taken_from(x));
    Numbers gradient = difference(forces, flowed);
    double shortest = std::numeric_limits<double>::infinity();
    int since = 0;  // turns since it was shortest
    for (int turn = 0; turn < most_turns && !are_all_zero(gradient); ++turn) {
      Numbers product = secants_.to_solve(gradient);
      auto solved = solve_on_places(product);
      if (!solved) return fail(solved.error());
      Numbers way = *std::move(solved);
      secants_.finish(way, product);
      // The energy falls against the way.
      const double start = dot_product(way, gradient);
      double part = -start / (dot_product(way, product) - places_->look_along(way));
      Numbers left;
      for (int tries = 1;; ++tries) {
        flowed = places_->flow_after(part);
        left = difference(sum(forces, part, product), flowed);
        // Its slope along the way is monotone: less of the way if it grows again.
        const double slope = -dot_product(way, left);
        if (!(slope > 0.5 * std::abs(start)) || tries == 30) break;
        part *= std::abs(start) / (std::abs(start) + slope);
      }
      places_->go(part);
      add_scaled(forces, part, product);
      const double length = std::abs(part) * longest(way, moving, peaks);
      for (double& number : way) number *= part;
      for (double& number : product) number *= part;
      secants_.learn(std::move(way), std::move(product), difference(left, gradient));
      gradient = std::move(left);
      // Rounding may let it become no shorter; or a number is not finite.
      since = length < 0.5 * shortest ? 0 : since + 1;
      shortest = std::min(shortest, length);
      if (!(length > shortest_way_) || (since > 20 && length < 1e-8)) {
        forces = std::move(flowed);
        return {};
      }
    }
    if (!are_all_zero(gradient)) return fail(not_settled(moving, most_turns));
    forces = std::move(flowed);
    return {};
  }

  // A^-1 forces, there.
  Result<Numbers> solve_on_places(const Numbers& forces) {
    if (on_places_.rows() == 0) on_places_.setZero(places_->all_unknowns(), 3);
    places_->add_to(on_places_, forces);
    auto x = solve(on_places_);
    places_->clear_in(on_places_);
    if (!x) return fail(x.error());
    return places_->taken_from(*x);
  }

  Result<Field> solve(const Field& forces) {
    if (context_.is_stopped()) return fail(ErrorCode::Interrupted, "interrupted");
    return plate_.solve(forces);
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
    double of_moving = 0, of_slopes = 0;
    const std::vector<int>& unknowns = places_->unknowns();
    for (std::size_t k = 0; k < unknowns.size(); ++k) {
      double& longest = unknowns[k] < moving ? of_moving : of_slopes;
      for (std::size_t n = 0; n < N; ++n) longest = std::max(longest, std::abs(way[k * N + n]));
    }
    const auto part = [](double length, double peak) { return length > 0 ? length / peak : 0; };
    return std::max(part(of_moving, peaks.moving), part(of_slopes, peaks.slopes));
  }

  FlowingPlate& plate_;
  const RunContext& context_;
  StepTerms terms_;  // known: with the forces of the plastic curvatures
  double shortest_way_;
  TimeSteps steps_;
  std::array<int, 3> components_;
  std::optional<FlowingPlaces<N>> places_;  // those that may flow; none: nothing has flowed
  Secants secants_{4};
  Growth growth_;    // with which the next step begins: that of the last one
  Field on_places_;  // 0 but while it is solved for
};

// The components that are not 0 and stay so.
std::vector<int> moving_components(const StepTerms& terms, const Motion& motion,
                                   const PlasticField& plastic) {
  std::vector<int> components;
  for (int k = 0; k < 3; ++k) {
    const bool is_still = terms.known.col(k).isZero(0) && motion.displacement.col(k).isZero(0) &&
                          motion.velocity.col(k).isZero(0) && plastic.col(k).isZero(0) &&
                          plastic.col(3 + k).isZero(0) && plastic.col(6 + k).isZero(0);
    if (!is_still) components.push_back(k);
  }
  return components;
}

}  // namespace

std::unique_ptr<PlasticSteps> make_plastic_steps(FlowingPlate& plate, const RunContext& context,
                                                 StepTerms terms, double hardening,
                                                 const TimeSteps& steps, const Motion& motion,
                                                 const PlasticField& plastic) {
  const std::vector<int> components = moving_components(terms, motion, plastic);
  if (components.size() == 1) {
    return std::make_unique<SettlingSteps<1>>(plate, context, std::move(terms), hardening, steps,
                                              std::array{components[0], 0, 0}, plastic);
  }
  return std::make_unique<SettlingSteps<3>>(plate, context, std::move(terms), hardening, steps,
                                            std::array{0, 1, 2}, plastic);
}

Result<void> run_plastic_steps(PlasticSteps& steps, int count, Motion& motion,
                               PlasticField& plastic) {
  for (int step = 0; step < count; ++step) {
    if (auto stepped = steps.step(motion, plastic); !stepped) return fail(stepped.error());
  }
  return {};
}

}  // namespace pliant
