#pragma once

#include "pliant/core/field.hpp"
#include "pliant/plate/outline/outline.hpp"
#include "pliant/plate/plate.hpp"

namespace pliant {

/// The system that a step solves: (shift I + L) w = f on the interior nodes of a clamped plate,
/// where L is `apply_stencil` with rim and tangents 0. Symmetric, and positive definite when the
/// stiffness is elliptic and shift >= 0. docs/model.md, eq. (8).
struct PlateSystem {
  Outline outline;      ///< of at least 3 x 3 nodes
  Stiffness stiffness;  ///< elliptic
  double shift = 0;     ///< rho/dt^2 + eta/dt, >= 0 [1/uv^4]

  friend bool operator==(const PlateSystem&, const PlateSystem&) = default;
};

/// One plate over one interval: everything that stays the same while its steps run. SPEC 4.
struct PlateProblem {
  Outline outline;  ///< of at least 3 x 3 nodes
  Stiffness stiffness;
  Dynamics dynamics;
  EdgeTangents tangents;
  Field load;  ///< #nodes x 3; rim rows are not read [length/uv^4]
};

/// Whether the problem's load and the state have a row for each node.
inline bool is_on_nodes(const PlateProblem& problem, const PlateState& state) {
  const int nodes = problem.outline.grid().node_count();
  return problem.load.rows() == nodes && state.displacement.rows() == nodes &&
         state.velocity.rows() == nodes;
}

}  // namespace pliant
