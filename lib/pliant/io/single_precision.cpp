#include "pliant/io/single_precision.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "pliant/io/row_order.hpp"

namespace pliant {

Result<std::vector<float>> to_single(const Field& positions, int frame) {
  std::vector<float> numbers(static_cast<std::size_t>(positions.size()));
  if (auto rounded = to_single(positions, frame, 0, numbers); !rounded) {
    return fail(rounded.error());
  }
  return numbers;
}

Result<void> to_single(const Field& positions, int frame, Eigen::Index first,
                       std::span<float> numbers) {
  to_row_order(positions, first, numbers);
  const auto beyond = std::find_if(numbers.begin(), numbers.end(),
                                   [](float number) { return !std::isfinite(number); });
  if (beyond == numbers.end()) return {};
  const Eigen::Index place = beyond - numbers.begin();
  const Eigen::Index row = first + place / 3;
  return fail(ErrorCode::NotFinite,
              fmt::format("vertex {} at frame {} has the coordinate {}, which is beyond the "
                          "single precision of the format; .npy, .obj and .ply hold double",
                          row, frame, positions(row, place % 3)));
}

Result<void> check_placement(const Placement& placement, PlacementNumbers numbers,
                             std::string_view surface, int frame) {
  const auto check = [&](const char* attribute, const Vector3d& vector,
                         bool is_single) -> Result<void> {
    for (int k = 0; k < 3; ++k) {
      const bool is_finite = std::isfinite(vector[k]);
      if (is_finite && !(is_single && std::isinf(static_cast<float>(vector[k])))) continue;
      return fail(ErrorCode::NotFinite,
                  fmt::format("surface \"{}\" at frame {} has a {} of {}, which is {}", surface,
                              frame, attribute, vector[k],
                              is_finite ? "beyond the single precision of the format; .usda holds "
                                          "double"
                                        : "no finite number"));
    }
    return {};
  };
  const bool is_single = numbers == PlacementNumbers::Single;
  if (auto checked = check("translate", placement.translate, is_single); !checked) return checked;
  // Written as a quaternion, or in degrees as double.
  if (auto checked = check("rotate", placement.rotate, false); !checked) return checked;
  return check("scale", placement.scale, is_single);
}

Result<float> to_single_seconds(int frame_count, double fps) {
  const double seconds = (frame_count - 1) / fps;
  const auto rounded = static_cast<float>(seconds);
  if (std::isfinite(rounded)) return rounded;
  return fail(
      ErrorCode::NotFinite,
      fmt::format("{} frames at {} frames/s take {} s, which is beyond the single precision "
                  "of the format",
                  frame_count, fps, seconds));
}

}  // namespace pliant
