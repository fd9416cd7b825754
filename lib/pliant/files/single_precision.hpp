#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/transform.hpp"

namespace pliant {

/// x y z of each row, rounded to the nearest float. Errors: NotFinite, naming frame and vertex,
/// counted from `first_index`, if a coordinate is not finite or beyond the range of float.
Result<std::vector<float>> to_single(const Field& positions, int frame, int first_index = 0);

/// The same for the rows from `first` on that fill `numbers`.
Result<void> to_single(const Field& positions, int frame, Eigen::Index first,
                       std::span<float> numbers, int first_index = 0);

/// How a format stores translation and scale of a placement.
enum class PlacementNumbers { Single, Double };

/// Whether a format can store a placement. Errors: NotFinite, naming the thing, frame and value, if
/// one of its numbers is not finite or beyond the range of the format's numbers, or a scale is too
/// small for them: a scale of 0 cannot be inverted.
Result<void> check_placement(const Placement& placement, PlacementNumbers numbers,
                             std::string_view thing, int frame);

/// Seconds from the first to the last of `frame_count` frames, rounded to float. Errors: NotFinite
/// if that is out of range.
Result<float> to_single_seconds(int frame_count, double fps);

}  // namespace pliant
