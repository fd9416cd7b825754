#pragma once

#include <algorithm>

namespace pliant::testing {

/// The slow way to find a first contact: looks at many moments.
struct ScannedWay {
  static constexpr int moments = 2000;

  int first = -1;    ///< the first moment without a gap; -1: none
  double least = 1;  ///< gap

  double time() const { return double(first) / moments; }
};

/// `gap_at(t)`: at part t of the way.
template <class GapAt>
ScannedWay scan(const GapAt& gap_at) {
  ScannedWay way;
  for (int m = 0; m <= ScannedWay::moments; ++m) {
    const double now = gap_at(double(m) / ScannedWay::moments);
    if (way.first < 0 && now <= 0) way.first = m;
    way.least = std::min(way.least, now);
  }
  return way;
}

}  // namespace pliant::testing
