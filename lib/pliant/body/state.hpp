#pragma once

#include <cstdint>
#include <vector>

#include "pliant/core/field.hpp"

namespace pliant {

/// The state that one frame passes on to the next.
struct BodyState {
  Field positions;   ///< #nodes x 3, object space [length]
  Field velocities;  ///< #nodes x 3: from the last solve, 0 at nodes it did not move [length/s]

  /// With `Release::Recover`: 1 for each node that the last solve left away from rest (#nodes);
  /// otherwise empty.
  std::vector<std::uint8_t> unsettled = {};

  friend bool operator==(const BodyState&, const BodyState&) = default;
};

}  // namespace pliant
