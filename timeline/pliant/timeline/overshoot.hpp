#pragma once

#include "pliant/timeline/key.hpp"

namespace pliant::timeline {

/// The two tangent lengths of a Bézier segment [frames].
struct Lengths {
  double start = 0;
  double end = 0;
};

/// Whether time runs forwards in the whole segment (docs/timeline.md, eq. 6). Violations by
/// rounding alone count as legal. Requires: span > 0, lengths >= 0.
bool is_function_of_time(Lengths lengths, double span);

/// The lengths after correction by a policy; unchanged if they need none (docs/timeline.md, section
/// "Overshoot"). `Error` changes none; the caller reports the error. Requires: span > 0, lengths >=
/// 0.
Lengths corrected(Lengths lengths, double span, Overshoot policy);

}  // namespace pliant::timeline
