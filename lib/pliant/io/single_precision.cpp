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
                          row + 1, frame, positions(row, place % 3)));
}

}  // namespace pliant
