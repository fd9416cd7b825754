#include "pliant/feedback/region_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {

double RegionMotion::seen_lambda() const {
  const auto weight = [](const ExcitedMode& mode) {
    return std::abs(mode.share) / std::sqrt(mode.lambda);
  };
  return std::max_element(
             modes.begin(), modes.end(),
             [&](const auto& one, const auto& other) { return weight(one) < weight(other); })
      ->lambda;
}

Dynamics RegionMotion::felt(double density, double damping) const {
  if (has_ratio) return damped_by_ratio({density, 0}, damping, slowest);
  return {density, damping * drag};
}

double RegionMotion::damping_of(const Dynamics& felt) const {
  const double felt_of_one = this->felt(felt.density, 1).damping;
  if (felt.damping == 0) return 0;
  return felt_of_one > 0 ? felt.damping / felt_of_one : std::numeric_limits<double>::infinity();
}

const TimeSteps& RegionMotion::steps(const Dynamics& felt) const {
  if (felt.density > 0) return swinging;
  return felt.damping > 0 ? creeping : still;
}

Swing RegionMotion::swing(const Dynamics& felt) const {
  return stepped_swing(seen_lambda(), felt, steps(felt), frame_seconds);
}

Settling RegionMotion::settling(const Dynamics& felt) const {
  return settling_of(modes, felt, steps(felt), frame_seconds);
}

}  // namespace pliant
