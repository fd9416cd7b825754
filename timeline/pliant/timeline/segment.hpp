#pragma once

#include <array>
#include <cstdint>

#include "pliant/timeline/bounds.hpp"
#include "pliant/timeline/cubic.hpp"
#include "pliant/timeline/easing.hpp"
#include "pliant/timeline/key.hpp"
#include "pliant/timeline/time_cubic.hpp"

namespace pliant::timeline {

/// The easings of a segment. Stored apart, as are the inverse time functions of Béziers, so that a
/// row of plain segments is small and contiguous in memory.
template <int D>
using Easings = std::array<Easing, D>;

/// One compiled segment of a curve, with values from `start` to `end` (docs/timeline.md, eq. 4).
template <int D>
struct Segment {
  enum class Kind : std::uint8_t {
    Cubic,   ///< time is linear in q: step, linear, and Bézier with handles of a third
    Jump,    ///< stepNext: constant, but the left key keeps its own value
    Bezier,  ///< `extra` is an index into the time cubics
    Easing,  ///< `extra` is an index into the easings; the cubics store v0, v1 and the change
  };

  double start = 0;   ///< [frame]
  double end = 1;     ///< [frame]
  double length = 1;  ///< [frames]
  Kind kind = Kind::Cubic;
  std::uint32_t extra = 0;
  std::array<std::array<Cubic, D>, 2> ends = {};  ///< value over q, from the start and from the end
};

/// The value cubics of a segment from both ends. `start_rate` and `end_rate` are dv/du there.
template <int D>
std::array<std::array<Cubic, D>, 2> value_cubics(const Value<D>& start, const Value<D>& end,
                                                 const Value<D>& start_rate,
                                                 const Value<D>& end_rate) {
  std::array<std::array<Cubic, D>, 2> ends;
  for (int c = 0; c < D; ++c) {
    const double change = end[c] - start[c];
    // As differences from the straight line, so that a straight line has exact zeros.
    const double start_excess = start_rate[c] - change;
    const double end_excess = end_rate[c] - change;
    const double c3 = start_excess + end_excess;
    ends[0][c] = {start[c], start_rate[c], -2 * start_excess - end_excess, c3};
    ends[1][c] = {end[c], -end_rate[c], 2 * end_excess + start_excess, -c3};
  }
  return ends;
}

}  // namespace pliant::timeline
