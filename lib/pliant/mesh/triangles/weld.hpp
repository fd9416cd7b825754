#pragma once

#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant {

/// For each point the first point that a chain of steps joins it with, none of them longer than
/// `distance`; a point without such neighbours is its own. Depends on the set of points only, not
/// on the way in which they are found. Requires: `points` is #points x 3, finite; distance >= 0.
/// Errors: almost all pairs of many points are almost that near; Interrupted. Cost: O(#points log
/// #points).
Result<std::vector<int>> welded(const Field& points, double distance,
                                const StopRequest& should_stop = {});

}  // namespace pliant
