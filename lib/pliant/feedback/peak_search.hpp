#pragma once

#include <functional>

#include "pliant/core/result.hpp"
#include "pliant/feedback/suggestion.hpp"

namespace pliant {

// Internal to feedback.

/// The factor of the magnitudes that was nearest to a peak.
struct FactorFound {
  double factor = 1;
  double peak = 0;  ///< at that factor [length]
  Obstacle obstacle = Obstacle::None;
  double other_peak = 0;  ///< LeavesReach: the peak on the other side of a jump; 0: there is none
};

/// The peak at a factor of the magnitudes, by playing the animation.
using PeakAt = std::function<Result<double>(double factor)>;

/// Finds the factor > 0 with which the peak is `wanted`, beginning with 1: by secants of the
/// logarithms, so that a peak that is proportional is found in two plays. Plays at most
/// `most_plays` times. Requires: wanted > 0. Errors: those of `peak_at`.
Result<FactorFound> find_factor(double wanted, int most_plays, const PeakAt& peak_at);

}  // namespace pliant
