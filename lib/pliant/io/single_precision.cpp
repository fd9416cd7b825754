#include "pliant/io/single_precision.hpp"

#include <cmath>

#include <fmt/format.h>

namespace pliant {

Result<std::vector<float>> to_single(const Field& positions, int frame) {
  std::vector<float> numbers;
  numbers.reserve(static_cast<std::size_t>(positions.size()));
  for (Eigen::Index row = 0; row < positions.rows(); ++row) {
    for (int k = 0; k < 3; ++k) {
      const auto number = static_cast<float>(positions(row, k));
      if (!std::isfinite(number)) {
        return fail(ErrorCode::NotFinite,
                    fmt::format("vertex {} at frame {} has the coordinate {}, which is beyond the "
                                "single precision of the format; .npy, .obj and .ply hold double",
                                row + 1, frame, positions(row, k)));
      }
      numbers.push_back(number);
    }
  }
  return numbers;
}

}  // namespace pliant
