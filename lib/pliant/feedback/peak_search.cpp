#include "pliant/feedback/peak_search.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace pliant {
namespace {

constexpr double played_miss = 3e-4;  // less than what rounding changes
constexpr double kept_miss = 1e-3;    // numbers that are there already may be rounded ones
constexpr double most_growth = 100;   // of the factor, in a play
constexpr double least_jump = 20;     // a steeper growth of logarithms is one, as far as is seen

struct Play {
  double factor = 1;
  double peak = 0;
};

double miss_of(const Play& play, double wanted) { return std::abs(play.peak / wanted - 1); }

double growth_of_logarithms(const Play& from, const Play& to) {
  return std::log(to.peak / from.peak) / std::log(to.factor / from.factor);
}

// Where the line through the logarithms of two plays reaches `wanted`. With one play it is
// proportional.
double secant(const Play& now, const std::optional<Play>& before, double wanted) {
  double slope = 1;
  if (before && before->factor != now.factor && before->peak > 0) {
    slope = std::clamp(growth_of_logarithms(*before, now), 0.2, 5.0);
  }
  const double growth = std::pow(wanted / now.peak, 1 / slope);
  return now.factor * std::clamp(growth, 1 / most_growth, most_growth);
}

}  // namespace

Result<FactorFound> find_factor(double wanted, int most_plays, const PeakAt& peak_at) {
  std::optional<Play> best, before, low, high;  // low: too little of a peak; high: too much
  const auto found = [&](Obstacle obstacle, double other_peak = 0) -> FactorFound {
    return {best->factor, best->peak, obstacle, other_peak};
  };
  const auto beyond_jump = [&] { return best->peak == low->peak ? high->peak : low->peak; };
  double factor = 1;
  int without_effect = 0;
  for (int plays = 0; plays < most_plays; ++plays) {
    const auto peak = peak_at(factor);
    if (!peak) return fail(peak.error());
    const Play now{factor, *peak};
    if (!best || miss_of(now, wanted) < miss_of(*best, wanted)) best = now;
    if (now.peak == 0 && !before) return found(Obstacle::NothingMoves);
    if (miss_of(now, wanted) <= (plays == 0 ? kept_miss : played_miss))
      return found(Obstacle::None);
    if (before && !(low && high)) {
      const bool has_effect = std::abs(now.peak / before->peak - 1) >
                              0.01 * std::min(1.0, std::abs(std::log(factor / before->factor)));
      without_effect = has_effect ? 0 : without_effect + 1;
    }
    (now.peak < wanted ? low : high) = now;
    if (low && high) {
      // A jump, or a peak that does not grow with the factor.
      const double room = std::abs(high->factor / low->factor - 1);
      if (room < 1e-4) return found(Obstacle::LeavesReach, beyond_jump());
      factor = secant(now, now.peak < wanted ? high : low, wanted);
      const auto [least, most] = std::minmax(low->factor, high->factor);
      // Every third play halves what is left.
      if (!(factor > least && factor < most) || plays % 3 == 2) factor = std::sqrt(least * most);
    } else {
      if (without_effect >= 2) return found(low ? Obstacle::LeavesReach : Obstacle::MovesAnyway);
      factor = now.peak > 0 ? secant(now, before, wanted) : now.factor * most_growth;
    }
    before = now;
  }
  if (low && high && low->peak > 0 && growth_of_logarithms(*low, *high) > least_jump)
    return found(Obstacle::LeavesReach, beyond_jump());
  return found(Obstacle::NotFound);
}

}  // namespace pliant
