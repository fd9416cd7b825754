#pragma once

#include "pliant/timeline/key.hpp"

namespace pliant::timeline {

/// The two tangent lengths of a Bézier segment [frames].
struct Lengths {
  double start = 0;
  double end = 0;
};

/// Whether time runs forwards all through a segment (docs/timeline.md, eq. 6). What breaks the rule
/// by rounding alone counts as legal. Requires: span > 0, lengths >= 0.
bool is_function_of_time(Lengths lengths, double span);

/// The lengths that a policy makes of given ones: the same when it leaves them alone
/// (docs/timeline.md, section "Overshoot"). `Error` leaves all alone; the caller refuses.
/// Requires: span > 0, lengths >= 0.
Lengths corrected(Lengths lengths, double span, Overshoot policy);

}  // namespace pliant::timeline
