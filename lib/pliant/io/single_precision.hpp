#pragma once

#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"

namespace pliant {

/// x y z of each row, rounded to the nearest float.
/// Errors: NotFinite, naming frame and vertex, where a coordinate is beyond the range of float.
Result<std::vector<float>> to_single(const Field& positions, int frame);

}  // namespace pliant
