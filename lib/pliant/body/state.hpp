#pragma once

#include <cstdint>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/plate/plate.hpp"

namespace pliant {

/// What pushed in the last solve: what loads and tangents of the next one change from.
struct LastPush {
  Field loads = {};  ///< #nodes x 3, 0 where nothing was solved, object space
  std::vector<std::uint8_t> unknowns = {};  ///< #nodes: 1 for those that the solve moved
  EdgeTangents tangents = {};

  friend bool operator==(const LastPush&, const LastPush&) = default;
};

/// The state that one frame passes on to the next.
struct BodyState {
  Field positions;   ///< #nodes x 3, object space [length]; if the rest shape is animated, the
                     ///< displacements from it
  Field velocities;  ///< #nodes x 3: from the last solve, 0 at nodes it did not move [length/s]

  /// With `Release::Recover`: 1 for each node that the last solve left away from rest (#nodes);
  /// otherwise empty.
  std::vector<std::uint8_t> unsettled = {};

  LastPush last = {};  ///< with `Integrator::Exact`; otherwise empty

  /// Of a body that yields: a row for each node of a grid, for each triangle of a surface [1].
  /// Those that no solve holds rest as they are. Otherwise empty.
  PlasticField plastic = {};

  friend bool operator==(const BodyState&, const BodyState&) = default;
};

}  // namespace pliant
