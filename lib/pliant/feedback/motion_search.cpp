#include "pliant/feedback/motion_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "pliant/feedback/scaled_channel.hpp"

namespace pliant {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

// A vibration that decays faster than this does not leave the 5 % again in which it has settled: it
// is not seen to ring. exp(-pi z / sqrt(1 - z^2)) = 0.05.
constexpr double most_ringing_ratio = 0.69;

// What the search aims at, and from where on it tells of a miss. [1]
constexpr double wanted_miss = 0.002;

double miss_of(double found, double wanted) { return std::abs(found / wanted - 1); }

// A number for a message.
std::string figure(double number) { return fmt::format("{:.4g}", number); }

// Materials along a line from much to little damping, and when each settles.
struct Sample {
  double damping = 0;  // relative to the critical one
  double settling = infinite;
};

// The damping along a line of materials with which it settles at a time, or nearest to it.
struct DampingFound {
  Sample nearest;
  std::optional<Sample> other = {};  // on the other side of a jump from `nearest`
  bool is_between = false;           // there are times on both sides of the one that is wanted
};

// When a material with that damping settles; null: there is none.
using SettlingTimeOf = std::function<std::optional<double>(double damping)>;

// Halves the interval between two samples on two sides of `wanted`.
DampingFound between(Sample a, Sample b, double wanted, const SettlingTimeOf& settling_at) {
  for (int turn = 0; turn < 100; ++turn) {
    const double middle = a.damping > 0 && b.damping > 0 ? std::sqrt(a.damping * b.damping)
                                                         : 0.5 * (a.damping + b.damping);
    if (middle == a.damping || middle == b.damping) break;
    const auto settling = settling_at(middle);
    if (!settling) break;
    const bool is_as_a = (*settling > wanted) == (a.settling > wanted);
    (is_as_a ? a : b) = {middle, *settling};
  }
  const bool a_is_nearer = miss_of(a.settling, wanted) <= miss_of(b.settling, wanted);
  const Sample near = a_is_nearer ? a : b, far = a_is_nearer ? b : a;
  if (miss_of(far.settling, wanted) <= wanted_miss) return {near, {}, true};
  return {near, far, true};
}

// The nearest to `wanted` among samples in the order of their dampings, and between them.
DampingFound nearest_of(std::span<const Sample> samples, double wanted,
                        const SettlingTimeOf& settling_at) {
  const auto miss = [&](const Sample& one) { return miss_of(one.settling, wanted); };
  DampingFound best{samples.front()};
  std::optional<DampingFound> jump;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (miss(samples[k]) < miss(best.nearest)) best = {samples[k]};
    if (k == 0 || (samples[k - 1].settling > wanted) == (samples[k].settling > wanted)) continue;
    DampingFound found = between(samples[k - 1], samples[k], wanted, settling_at);
    if (!found.other) return found;
    if (!jump || miss(found.nearest) < miss(jump->nearest)) jump = found;
  }
  return jump ? *jump : best;
}

class MaterialSearch {
 public:
  MaterialSearch(const RegionMotion& motion, const Material& now)
      : motion_(motion), lambda_(motion.seen_lambda()), now_(now) {}

  MaterialFound for_settling(double wanted) const;
  MaterialFound for_frequency(double wanted) const;
  MaterialFound for_both(double settling, double frequency) const;

 private:
  // Dynamics of which one vibration, the one that is seen, has this damping ratio in nature.
  Dynamics damped(double density, double ratio) const {
    return damped_by_ratio({density, 0}, ratio, lambda_);
  }
  Material material(const Dynamics& felt) const { return {felt.density, motion_.damping_of(felt)}; }
  // Whether it is seen to ring.
  bool rings(const Dynamics& felt) const {
    return felt.density > 0 && motion_.swing(felt).damping_ratio <= most_ringing_ratio;
  }
  // The density of an undamped vibration of that frequency in nature.
  double natural_density(double frequency) const {
    const double omega =
        2 * std::numbers::pi * frequency * (motion_.frame_seconds / motion_.interval);
    return lambda_ / (omega * omega);
  }

  std::optional<double> density_for(double frequency, double ratio) const;
  double fastest_density(double frequency) const;
  double most_shown() const { return 0.5 / motion_.frame_seconds; }
  std::string_view damping_word() const { return motion_.has_ratio ? "dampingRatio" : "damping"; }
  bool can_damp() const { return motion_.has_ratio || motion_.drag > 0; }

  std::string other_steps(const std::function<bool(const MaterialSearch&)>& is_enough) const;
  Miss steps_damp(double damping, double settling,
                  const std::function<bool(const MaterialSearch&)>& is_enough) const;
  Miss steps_too_long(double frequency) const;
  Miss too_fast() const;
  Miss too_soon(double wanted, double soonest, std::string_view reason) const;

  const RegionMotion& motion_;
  double lambda_;
  Material now_;
};

// What of the time steps would help: with how many in a frame is it enough?
std::string MaterialSearch::other_steps(
    const std::function<bool(const MaterialSearch&)>& is_enough) const {
  RegionMotion motion = motion_;
  const auto with = [&](double count) {
    // Three digits, rounded down, so that a frame has as many steps or a few more.
    const double dt = motion_.interval / count;
    const double place = std::pow(10, std::floor(std::log10(dt)) - 2);
    return std::floor(dt / place * (1 + 1e-12)) * place;
  };
  const auto is_enough_with = [&](double count) {
    motion.swinging = divide_interval(motion_.interval, with(count), motion_.stepping);
    return is_enough({motion, now_});
  };
  double low = motion_.swinging.count, high = low;
  while (high < max_steps / 4.0 && (high == low || !is_enough_with(high))) high *= 2;
  if (!is_enough_with(high)) return "integrator=\"newmark\" helps";
  while (high - low > 1) {
    const double middle = std::floor((low + high) / 2);
    (is_enough_with(middle) ? high : low) = middle;
  }
  return fmt::format("dt=\"{:.3g}\" or integrator=\"newmark\" helps", with(high));
}

Miss MaterialSearch::steps_damp(double damping, double settling,
                                const std::function<bool(const MaterialSearch&)>& is_enough) const {
  return {
      Obstacle::StepsDamp,
      fmt::format("backward Euler's steps of {} s damp it: with {} {} it settles in {} s at the "
                  "latest; {}",
                  figure(motion_.swinging.length), damping_word(), figure(damping),
                  figure(settling), other_steps(is_enough))};
}

// Requires: without damping it is not seen to ring with that frequency.
Miss MaterialSearch::steps_too_long(double frequency) const {
  const Dynamics fastest = damped(fastest_density(frequency), 0);
  return {Obstacle::StepsTooLong,
          fmt::format("steps of {} s show {} Hz at most, since they damp what is faster; {}",
                      figure(motion_.swinging.length), figure(motion_.swing(fastest).frequency),
                      other_steps([&](const MaterialSearch& with) {
                        const auto density = with.density_for(frequency, 0);
                        return density && with.rings(with.damped(*density, 0));
                      }))};
}

Miss MaterialSearch::too_fast() const {
  return {Obstacle::FrameRate, fmt::format("frames {} s apart show {} Hz at most",
                                           figure(motion_.frame_seconds), figure(most_shown()))};
}

Miss MaterialSearch::too_soon(double wanted, double soonest, std::string_view reason) const {
  if (wanted < motion_.frame_seconds) {
    return {Obstacle::FrameRate,
            fmt::format("frames are {} s apart", figure(motion_.frame_seconds))};
  }
  return {Obstacle::TooSoon,
          fmt::format("it settles in {} s at the soonest, since {}", figure(soonest), reason)};
}

Miss between_swings(const DampingFound& found) {
  if (!found.other) return {};
  const double a = found.nearest.settling, b = found.other->settling;
  return {
      Obstacle::BetweenSwings,
      fmt::format("with a little less damping it swings out of the 5 % once more: it settles in "
                  "{} s or in {} s, and at no time between",
                  figure(std::min(a, b)), figure(std::max(a, b)))};
}

// The density is kept, and so is whether it rings or creeps: the two look different.
MaterialFound MaterialSearch::for_settling(double wanted) const {
  MaterialFound found{now_, {}, {}};
  const bool is_static = motion_.has_ratio && now_.density == 0;
  if (is_static || !can_damp()) {
    found.settling = {is_static ? Obstacle::NoInertia : Obstacle::NoDamping,
                      is_static ? "without density a damping ratio damps nothing"
                                : "a map makes its damping 0 where it moves"};
    return found;
  }
  // Without density there is no critical damping: the one that settles at the time in nature.
  const double unit = now_.density > 0
                          ? 2 * std::sqrt(lambda_ * now_.density)
                          : lambda_ * wanted * (motion_.interval / motion_.frame_seconds) / 3;
  const auto felt = [&](double damping) { return Dynamics{now_.density, damping * unit}; };
  const SettlingTimeOf settling_at = [&](double damping) {
    return std::optional(motion_.settling(felt(damping)).time);
  };
  // From the soonest on, to more and to less damping, until it takes far too long.
  const double soonest = now_.density > 0 ? most_ringing_ratio : 1e-6;
  const auto walk = [&](double factor, double end) {
    std::vector<Sample> samples;
    for (double damping = soonest; factor > 1 ? damping < end : damping > end; damping *= factor) {
      samples.push_back({damping, *settling_at(damping)});
      const std::size_t count = samples.size();
      const bool rises = count > 1 && samples[count - 1].settling > samples[count - 2].settling;
      if (rises && samples.back().settling > 4 * wanted) return samples;
    }
    samples.push_back({factor > 1 ? end : 0, *settling_at(factor > 1 ? end : 0)});
    return samples;
  };
  const auto ringing = [&] { return nearest_of(walk(0.97, 1e-5), wanted, settling_at); };
  const auto creeping = [&] { return nearest_of(walk(1.05, 1e6), wanted, settling_at); };
  const double ratio = motion_.felt(now_.density, now_.damping).damping / unit;
  const bool creeps = now_.density == 0 || ratio > soonest;
  const DampingFound best = creeps ? creeping() : ringing();
  const auto is_met = [&](const DampingFound& one) {
    return miss_of(one.nearest.settling, wanted) <= wanted_miss;
  };
  found.material = material(felt(best.nearest.damping));
  if (is_met(best)) return found;
  found.settling = between_swings(best);
  if (!best.is_between && best.nearest.settling < wanted) {
    found.settling =
        steps_damp(found.material.damping, best.nearest.settling, [&](const MaterialSearch& with) {
          return with.motion_.settling({now_.density, 0}).time >= wanted;
        });
  } else if (!best.is_between && best.nearest.settling > wanted) {
    found.settling = too_soon(wanted, best.nearest.settling,
                              "with more damping it creeps; a lower density helps");
  }
  if (creeps || found.settling.obstacle == Obstacle::None) return found;
  if (const DampingFound other = creeping(); is_met(other)) {
    found.settling.reason +=
        fmt::format("; with {} {} it creeps there in that time", damping_word(),
                    figure(material(felt(other.nearest.damping)).damping));
  }
  return found;
}

// The density with which the vibration, of a damping ratio in nature, is seen with a frequency;
// null: none. The frequency falls with density.
std::optional<double> MaterialSearch::density_for(double frequency, double ratio) const {
  const auto frequency_at = [&](double density) {
    return motion_.swing(damped(density, ratio)).frequency;
  };
  double low = 1e-9 * natural_density(frequency), high = 1e3 * natural_density(frequency);
  if (!(frequency_at(low) >= frequency) || !(frequency_at(high) < frequency)) return {};
  for (int turn = 0; turn < 100 && high > low * (1 + 1e-12); ++turn) {
    const double middle = std::sqrt(low * high);
    (frequency_at(middle) >= frequency ? low : high) = middle;
  }
  return low;
}

// The density with which it is seen to ring fastest, without damping. Its damping ratio, that of
// the steps, falls with density.
double MaterialSearch::fastest_density(double frequency) const {
  double low = 1e-9 * natural_density(frequency), high = 1e3 * natural_density(frequency);
  for (int turn = 0; turn < 100; ++turn) {
    const double middle = std::sqrt(low * high);
    (rings(damped(middle, 0)) ? high : low) = middle;
  }
  return high;
}

MaterialFound MaterialSearch::for_frequency(double wanted) const {
  MaterialFound found{now_, {}, {}};
  if (wanted > most_shown()) {
    found = for_frequency(most_shown());
    found.frequency = too_fast();
    return found;
  }
  const auto felt = [&](double density) { return motion_.felt(density, now_.damping); };
  const auto frequency_at = [&](double density) { return motion_.swing(felt(density)).frequency; };
  // Down from a density with which it rings too slowly.
  const double natural = natural_density(wanted);
  double slow = 1e3 * natural;
  while (!rings(felt(slow)) && slow < 1e15 * natural) slow *= 10;
  const bool ever_rings = rings(felt(slow));
  double fast = slow;
  constexpr double step = 0.97;
  while (ever_rings && frequency_at(fast) < wanted && rings(felt(step * fast)) &&
         fast > 1e-9 * natural) {
    slow = fast;
    fast *= step;
  }
  if (ever_rings && frequency_at(fast) >= wanted) {
    for (int turn = 0; turn < 60; ++turn) {
      const double middle = std::sqrt(slow * fast);
      (frequency_at(middle) >= wanted ? fast : slow) = middle;
    }
    found.material.density = fast;
    return found;
  }
  if (ever_rings) found.material.density = fast;
  const auto undamped = density_for(wanted, 0);
  if (undamped && rings(damped(*undamped, 0))) {
    found.frequency = {
        Obstacle::Overdamped,
        ever_rings
            ? fmt::format("with {} {} it rings with {} Hz at most; less of it helps, also "
                          "beside a time to settle",
                          damping_word(), figure(now_.damping), figure(frequency_at(fast)))
            : fmt::format("with {} {} it does not ring; less of it helps, also beside a time "
                          "to settle",
                          damping_word(), figure(now_.damping))};
    return found;
  }
  found.frequency = steps_too_long(wanted);
  return found;
}

// Every damping ratio has a density with which the frequency is seen; which ratio settles in time?
MaterialFound MaterialSearch::for_both(double settling, double frequency) const {
  MaterialFound found;
  if (frequency > most_shown()) {
    found = for_both(settling, most_shown());
    found.frequency = too_fast();
    return found;
  }
  const auto felt = [&](double ratio) -> std::optional<Dynamics> {
    const auto density = density_for(frequency, ratio);
    if (!density || !rings(damped(*density, ratio))) return {};
    return damped(*density, ratio);
  };
  if (!felt(0)) {
    found.material = material(damped(fastest_density(frequency), 0));
    found.frequency = steps_too_long(frequency);
    found.settling = {Obstacle::StepsTooLong, "its steps damp it, as above"};
    return found;
  }
  const SettlingTimeOf settling_at = [&](double ratio) -> std::optional<double> {
    const auto dynamics = felt(ratio);
    if (!dynamics) return {};
    return motion_.settling(*dynamics).time;
  };
  std::vector<Sample> samples;
  for (double ratio = most_ringing_ratio; ratio > 1e-5 && can_damp(); ratio *= 0.97) {
    if (const auto time = settling_at(ratio)) samples.push_back({ratio, *time});
    if (!samples.empty() && samples.back().settling > 4 * settling) break;
  }
  if (samples.empty() || samples.back().settling <= 4 * settling)
    samples.push_back({0, *settling_at(0)});
  const DampingFound best = nearest_of(samples, settling, settling_at);
  found.material = material(*felt(best.nearest.damping));
  if (miss_of(best.nearest.settling, settling) <= wanted_miss) return found;
  found.settling = between_swings(best);
  if (best.is_between) return found;
  if (!can_damp()) {
    found.settling = {Obstacle::NoDamping, "a map makes its damping 0 where it moves"};
  } else if (best.nearest.settling < settling) {
    found.settling =
        steps_damp(found.material.damping, best.nearest.settling, [&](const MaterialSearch& with) {
          const auto density = with.density_for(frequency, 0);
          return density && with.motion_.settling(with.damped(*density, 0)).time >= settling;
        });
  } else if (best.nearest.settling > settling) {
    found.settling = too_soon(
        settling, best.nearest.settling,
        fmt::format("with more damping it is not seen to ring with {} Hz", figure(frequency)));
  }
  return found;
}

}  // namespace

MaterialFound find_material(const RegionMotion& motion, const Material& now,
                            std::optional<double> settling, std::optional<double> frequency) {
  const auto miss = [&](const Material& material) {
    const Dynamics felt = motion.felt(material.density, material.damping);
    return std::max(settling ? miss_of(motion.settling(felt).time, *settling) : 0,
                    frequency ? miss_of(motion.swing(felt).frequency, *frequency) : 0);
  };
  if ((!settling && !frequency) || miss(now) <= wanted_miss) return {now, {}, {}};
  const MaterialSearch search(motion, now);
  MaterialFound found = !frequency ? search.for_settling(*settling)
                        : settling ? search.for_both(*settling, *frequency)
                                   : search.for_frequency(*frequency);
  // Of rounded numbers nearby the best ones, since the time to settle may change steeply. Where
  // their neighbours settle at quite another time, they are too near to a jump for what modes leave
  // out.
  const auto is_steady = [&](const Material& material) {
    const auto time = [&](double factor) {
      return motion.settling(motion.felt(material.density, material.damping * factor)).time;
    };
    constexpr double away = 1e-3, most_change = 0.05;
    return !settling || std::max(miss_of(time(1 - away), time(1)),
                                 miss_of(time(1 + away), time(1))) <= most_change;
  };
  const Material exact = found.material;
  constexpr double step = 2.5e-4, unsteady = 0.015;
  double least = infinite;
  const auto is_good_enough = [&](const Material& near) {
    const double other = miss(near) + (is_steady(near) ? 0 : unsteady);
    if (other < least) {
      least = other;
      found.material = near;
    }
    return least <= wanted_miss;
  };
  for (const int k : {0, 1, -1, 2, -2, 3, -3}) {
    const double density = frequency ? rounded(exact.density * (1 + k * step)) : exact.density;
    for (const int n : {0, 1, -1, 2, -2, 3, -3, 4, -4, 6, -6, 8, -8, 12, -12, 16, -16}) {
      const double damping = settling ? rounded(exact.damping * (1 + n * step)) : exact.damping;
      if (is_good_enough({density, damping})) return found;
      if (!settling) break;
    }
    if (!frequency) break;
  }
  const bool is_near =
      found.settling.obstacle == Obstacle::None && found.frequency.obstacle == Obstacle::None;
  if (is_near && miss(found.material) > goal_tolerance) {
    found.settling = {
        Obstacle::BetweenSwings,
        "one swing more or less just leaves the 5 % there: 4 digits of the numbers are "
        "too coarse"};
  }
  return found;
}

}  // namespace pliant
