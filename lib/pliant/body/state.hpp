#pragma once

#include <algorithm>
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

/// Nodes inside a solid, and how deep.
struct NodesInside {
  int count = 0;
  double depth = 0;  ///< of the deepest [length]

  void add(double depth_of_node) {
    ++count;
    depth = std::max(depth, depth_of_node);
  }
  void add(const NodesInside& others) {
    count += others.count;
    depth = std::max(depth, others.depth);
  }

  friend bool operator==(const NodesInside&, const NodesInside&) = default;
};

/// What a collider did to a body in the solve that led to a state. Nothing is computed from it.
struct ContactFacts {
  int collider = 0;             ///< as of `SampledCollider`
  std::vector<int> nodes = {};  ///< that it pushed in the last step, ascending
  Vector3d force = {0, 0, 0};   ///< on all of them, world; on triangles without the area of a node
  bool touched = false;         ///< whether it pushed in some step
  NodesInside thrown = {};      ///< nodes that began inside, and were thrown out at once
  NodesInside held = {};        ///< nodes that do not move, and are inside at the end
  std::vector<int> squeezed =
      {};  ///< colliders that held on to nodes which it pressed against them

  friend bool operator==(const ContactFacts&, const ContactFacts&) = default;
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

  /// Of each collider that the last solve met; empty: there was none, or no solve.
  std::vector<ContactFacts> contacts = {};

  friend bool operator==(const BodyState&, const BodyState&) = default;
};

}  // namespace pliant
