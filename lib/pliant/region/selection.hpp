#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/grid.hpp"
#include "pliant/region/combine.hpp"

namespace pliant {

/// One force in the selection of a frame: its boxes, the region it acts in, and its effect there.
struct ForceSelection {
  Box deformation;   ///< box of the nodes nearer than the deformation radius; empty: there are none
  Box force;         ///< box of the nodes nearer than the force radius; may exceed the region
  int selector = 0;  ///< index of the force whose deformation box it uses; usually the force itself
  int region = -1;   ///< index of the region it acts in; -1: none

  // Known once the body has planned its step.
  bool pushes = false;   ///< whether it moves any node
  bool is_lost = false;  ///< whether it selects nodes on the rest mesh, but none now

  friend bool operator==(const ForceSelection&, const ForceSelection&) = default;
};

/// A part of a region that is cut out of a surface, counted.
struct CutCounts {
  int inside_nodes = 0;
  int held_nodes = 0;
  int cells = 0;

  friend bool operator==(const CutCounts&, const CutCounts&) = default;
  friend CutCounts operator+(const CutCounts& a, const CutCounts& b) {
    return {a.inside_nodes + b.inside_nodes, a.held_nodes + b.held_nodes, a.cells + b.cells};
  }
};

/// The region selection of thesis 5.3, fig. 5; SPEC 5: which nodes a frame solves, and which forces
/// act on them.
struct Selection {
  std::vector<ForceSelection> forces;  ///< in the order of the forces
  std::vector<Box> others;             ///< boxes that no force selects, but that are solved too
  std::vector<Region> regions;         ///< in the order of `combine`, also those too small to solve
  Grid grid = {};                      ///< of the nodes; matters only if it is closed

  /// The forces that act in each region, ascending: members[member_starts[k]] to the start of the
  /// next.
  std::vector<int> members = {};
  std::vector<int> member_starts = {};  ///< #regions + 1

  Box box() const;  ///< smallest box around all regions; empty: there are none

  std::span<const int> forces_of(std::size_t region) const {
    const int begin = member_starts[region], end = member_starts[region + 1];
    return {members.data() + begin, static_cast<std::size_t>(end - begin)};
  }

  /// The patches that force k acts in.
  std::span<const Patch> patches_of_force(std::size_t k) const;

  friend bool operator==(const Selection&, const Selection&) = default;
};

/// The loads of one force on the interior nodes of its region, summed. World [length b/uv^4]
struct Push {
  Vector3d sum = {0, 0, 0};  ///< of the loads on nodes
  int node_count = 0;        ///< nodes whose load is not 0
};

}  // namespace pliant
