#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant {

/// The most takes that a sweep may have.
inline constexpr std::size_t most_takes = 1'000'000;

/// What an axis of a sweep runs through: texts, or an interval that is sampled.
struct AxisValues {
  std::vector<std::string> texts;  ///< in their order; empty: an interval
  double from = 0;                 ///< of the interval
  double to = 0;

  bool is_interval() const { return texts.empty(); }
};

/// Reads the values of an axis:
/// - `a,b,c`: these texts, trimmed;
/// - `A:B:N`: N numbers from A to B, the k-th A + (B-A)k/(N-1), the last exactly B;
/// - `A:B:N:log`: the same in the logarithm, the first exactly A; A and B have one sign;
/// - `A..B`: all integers from A to B;
/// - `A:B`: an interval.
/// Computed numbers are the shortest texts that read back the same double.
///
/// Errors: InvalidInput, in words that can follow `--vary PATH=VALUES: `: an empty value, a count
/// that is not from 1 to `most_takes`, A..B that falls, a logarithm of 0 or of two signs, a number
/// that is not finite. Interrupted.
Result<AxisValues> parse_axis_values(std::string_view text, const StopRequest& should_stop = {});

}  // namespace pliant
