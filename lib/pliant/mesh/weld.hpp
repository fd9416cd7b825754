#pragma once

#include <vector>

#include "pliant/core/field.hpp"

namespace pliant {

/// For each point the first point that a chain of steps joins it with, none of them longer than
/// `distance`; a point without such neighbours is its own. Depends on the set of points only, not
/// on the way in which they are found. Requires: `points` is #points x 3, finite; distance >= 0.
/// Cost: O(#points log #points) unless many groups are nearly joined.
std::vector<int> welded(const Field& points, double distance);

}  // namespace pliant
