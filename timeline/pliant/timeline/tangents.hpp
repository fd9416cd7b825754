#pragma once

#include <vector>

#include "pliant/timeline/key.hpp"

namespace pliant::timeline {

/// The slopes of one component on both sides of every key [unit/frame].
struct Slopes {
  std::vector<double> in;
  std::vector<double> out;
};

/// The slopes of the tangents of component c (docs/timeline.md, eq. 7 to 13). The slope of a handle
/// is its value over its time, 0 if its time is 0 or points backwards. Slopes overflow if keys are
/// too close for their change of value; the caller checks. Requires: at least one key, frames
/// strictly increasing.
template <int D>
Slopes tangent_slopes(const std::vector<Key<D>>& keys, const Extrapolation<D>& before,
                      const Extrapolation<D>& after, int c);

extern template Slopes tangent_slopes(const std::vector<Key<1>>&, const Extrapolation<1>&,
                                      const Extrapolation<1>&, int);
extern template Slopes tangent_slopes(const std::vector<Key<3>>&, const Extrapolation<3>&,
                                      const Extrapolation<3>&, int);

}  // namespace pliant::timeline
