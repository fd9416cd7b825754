#pragma once

#include <span>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/grid.hpp"
#include "pliant/forces/force.hpp"

namespace pliant {

/// What one force selects.
struct ForceSelection {
  Box deformation;  ///< box of the nodes nearer than the deformation radius; empty: none are
  Box force;        ///< box of the nodes nearer than the force radius; may reach past the region

  friend bool operator==(const ForceSelection&, const ForceSelection&) = default;
};

/// The original region selection: thesis 5.3, fig. 5; SPEC 5.
struct Selection {
  Box region;                          ///< box of all deformation boxes; empty: nothing is selected
  std::vector<ForceSelection> forces;  ///< in the order of the forces

  friend bool operator==(const Selection&, const Selection&) = default;
};

/// Selects by distance, strictly less than each radius, on nodes (#nodes x 3, world space). A box
/// over (u,v) is a box of nodes, and it holds also the nodes that lie outside every sphere: that is
/// what makes the region an M x N grid.
/// Requires: #nodes = grid.node_count().
Selection select_region(const Grid& grid, const Field& nodes, std::span<const SampledForce> forces);

/// The sum of all forces on each node of `selection.region` (#region nodes x 3, row = j * columns +
/// i counted within the region, world space): force k acts on the nodes inside its force box.
/// Forces add up in the order given. Requires: `selection` is what `select_region` gave for the
/// same arguments, its region not empty.
Field assemble_load(const Grid& grid, const Field& nodes, std::span<const SampledForce> forces,
                    const Selection& selection);

}  // namespace pliant
