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

/// The same of the rows from `first` on that fill `numbers`.
Result<void> to_single(const Field& positions, int frame, Eigen::Index first,
                       std::span<float> numbers, int first_index = 0);

/// How a format holds translation and scale of a placement.
enum class PlacementNumbers { Single, Double };

/// Whether a format can hold a placement. Errors: NotFinite, naming surface, frame and value, if
/// one of its numbers is not finite or beyond the range of the format's, or a scale below it: a
/// surface of scale 0 has no way back.
Result<void> check_placement(const Placement& placement, PlacementNumbers numbers,
                             std::string_view surface, int frame);

/// Seconds from the first to the last of `frame_count` frames, rounded to float.
/// Errors: NotFinite where that is beyond its range.
Result<float> to_single_seconds(int frame_count, double fps);

}  // namespace pliant
