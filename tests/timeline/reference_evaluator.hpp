#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "pliant/timeline/key.hpp"

namespace pliant::testing {

/// A Bézier segment as its four control points, solved by bisection in long double: slow, simple,
/// and independent of the engine. Requires: time does not run backwards.
struct ReferenceSegment {
  long double t[4];
  long double v[4];

  static long double bernstein(const long double (&p)[4], long double u) {
    const long double w = 1 - u;
    return w * w * w * p[0] + 3 * w * w * u * p[1] + 3 * w * u * u * p[2] + u * u * u * p[3];
  }

  long double parameter(long double frame) const {
    long double low = 0;
    long double high = 1;
    for (int round = 0; round < 80; ++round) {
      const long double middle = (low + high) / 2;
      (bernstein(t, middle) <= frame ? low : high) = middle;
    }
    return (low + high) / 2;
  }

  long double value(long double frame) const { return bernstein(v, parameter(frame)); }
};

/// Keys whose tangents are slopes with lengths (a third of the segment when absent), all segments
/// Bézier, no overshoot.
inline std::vector<ReferenceSegment> reference_segments(const std::vector<Key<1>>& keys) {
  std::vector<ReferenceSegment> segments;
  for (std::size_t k = 0; k + 1 < keys.size(); ++k) {
    const long double t0 = keys[k].frame;
    const long double t1 = keys[k + 1].frame;
    const long double v0 = keys[k].value[0];
    const long double v1 = keys[k + 1].left.value_or(keys[k + 1].value)[0];
    const auto length = [&](const Tangent<1>& tangent) -> long double {
      return tangent.length ? static_cast<long double>(*tangent.length) : (t1 - t0) / 3;
    };
    const long double out = length(keys[k].out);
    const long double in = length(keys[k + 1].in);
    const long double out_slope = keys[k].out.slope[0];
    const long double in_slope = keys[k + 1].in.slope[0];
    segments.push_back(
        {{t0, t0 + out, t1 - in, t1}, {v0, v0 + out_slope * out, v1 - in_slope * in, v1}});
  }
  return segments;
}

inline long double reference_value(const std::vector<ReferenceSegment>& segments,
                                   long double frame) {
  for (const ReferenceSegment& segment : segments) {
    if (frame < segment.t[3]) return segment.value(frame);
  }
  return segments.back().v[3];
}

}  // namespace pliant::testing
