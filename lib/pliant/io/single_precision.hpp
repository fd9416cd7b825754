#pragma once

#include <span>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"

namespace pliant {

/// x y z of each row, rounded to the nearest float.
/// Errors: NotFinite, naming frame and vertex, where a coordinate is beyond the range of float.
Result<std::vector<float>> to_single(const Field& positions, int frame);

/// The same of the rows from `first` on that fill `numbers`.
Result<void> to_single(const Field& positions, int frame, Eigen::Index first,
                       std::span<float> numbers);

}  // namespace pliant
