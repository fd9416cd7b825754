#pragma once

#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/grid.hpp"
#include "pliant/region/combine.hpp"

namespace pliant {

/// The boxes of one force, and the region it acts in.
struct ForceSelection {
  Box deformation;   ///< box of the nodes nearer than the deformation radius; empty: there are none
  Box force;         ///< box of the nodes nearer than the force radius; may exceed the region
  int selector = 0;  ///< index of the force whose deformation box it uses; usually the force itself
  int region = -1;   ///< index of the region it acts in; -1: none

  friend bool operator==(const ForceSelection&, const ForceSelection&) = default;
};

/// The region selection of thesis 5.3, fig. 5; SPEC 5.
struct Selection {
  Box region;                          ///< smallest box around all regions; empty: there are none
  std::vector<ForceSelection> forces;  ///< in the order of the forces
  std::vector<Region> regions;         ///< in the order of `combine`, also those too small to solve

  friend bool operator==(const Selection&, const Selection&) = default;
};

/// The loads of one force on the interior nodes of its region, summed. World [length b/uv^4]
struct Push {
  Vector3d sum = {0, 0, 0};  ///< of the loads on nodes
  int node_count = 0;        ///< nodes whose load is not 0
};

}  // namespace pliant
