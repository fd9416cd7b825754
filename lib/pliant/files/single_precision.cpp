#include "pliant/files/single_precision.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "pliant/files/row_order.hpp"

namespace pliant {

Result<std::vector<float>> to_single(const Field& positions, int frame, int first_index) {
  std::vector<float> numbers(static_cast<std::size_t>(positions.size()));
  if (auto rounded = to_single(positions, frame, 0, numbers, first_index); !rounded) {
    return fail(rounded.error());
  }
  return numbers;
}

Result<void> to_single(const Field& positions, int frame, Eigen::Index first,
                       std::span<float> numbers, int first_index) {
  to_row_order(positions, first, numbers);
  const auto beyond = std::find_if(numbers.begin(), numbers.end(),
                                   [](float number) { return !std::isfinite(number); });
  if (beyond == numbers.end()) return {};
  const Eigen::Index place = beyond - numbers.begin();
  const Eigen::Index row = first + place / 3;
  const double coordinate = positions(row, place % 3);
  return fail(
      ErrorCode::NotFinite,
      fmt::format(
          "vertex {} at frame {} has the coordinate {}, which is {}", first_index + row, frame,
          coordinate,
          std::isfinite(coordinate)
              ? "too large for the single precision of the format; .npy, .obj and .ply store double"
              : "not finite"));
}

Result<void> check_placement(const Placement& placement, PlacementNumbers numbers,
                             std::string_view thing, int frame) {
  const auto refused = [&](const char* attribute, double number, const char* reason) {
    return fail(ErrorCode::NotFinite, fmt::format("{} at frame {} has a {} of {}, which is {}",
                                                  thing, frame, attribute, number, reason));
  };
  const auto check = [&](const char* attribute, const Vector3d& vector,
                         bool is_single) -> Result<void> {
    for (const double number : vector) {
      if (!std::isfinite(number)) return refused(attribute, number, "not finite");
      if (is_single && std::isinf(static_cast<float>(number))) {
        return refused(attribute, number,
                       "too large for the single precision of the format; .usda stores double");
      }
    }
    return {};
  };
  const bool is_single = numbers == PlacementNumbers::Single;
  if (auto checked = check("translate", placement.translate, is_single); !checked) return checked;
  // Written as a quaternion, or in degrees as double.
  if (auto checked = check("rotate", placement.rotate, false); !checked) return checked;
  if (auto checked = check("scale", placement.scale, is_single); !checked) return checked;
  for (const double number : placement.scale) {
    if (is_single && std::fabs(number) < std::numeric_limits<float>::min()) {
      return refused("scale", number,
                     "too small for the single precision of the format; .usda stores double");
    }
  }
  return {};
}

Result<float> to_single_seconds(int frame_count, double fps) {
  const double seconds = (frame_count - 1) / fps;
  const auto rounded = static_cast<float>(seconds);
  if (std::isfinite(rounded)) return rounded;
  return fail(ErrorCode::NotFinite, fmt::format("{} frames at {} frames/s last {} s, which is too "
                                                "large for the single precision of the format",
                                                frame_count, fps, seconds));
}

}  // namespace pliant
