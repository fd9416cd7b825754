#pragma once

#include "pliant/core/result.hpp"
#include "pliant/timeline/channel.hpp"

namespace pliant {

// Internal to feedback.

/// A number rounded to 4 significant digits; with a `range` > 0, to 4 significant digits of that if
/// it is smaller.
double rounded(double number, double range = 0);

/// The channel with all its values multiplied, and rounded: a curve keeps its keys and their
/// timing, its numbers are rounded by the range of its keys' values. Requires: factor > 0. Errors:
/// InvalidInput if a number of a curve becomes too large.
Result<Channel<1>> scaled(const Channel<1>& channel, double factor);

/// The constant, or the value of a key that is farthest from 0.
double farthest_value(const Channel<1>& channel);

}  // namespace pliant
