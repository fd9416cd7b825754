#pragma once

#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/grid.hpp"
#include "pliant/region/combine.hpp"

namespace pliant {

/// What one force selects, and where it acts.
struct ForceSelection {
  Box deformation;   ///< box of the nodes nearer than the deformation radius; empty: none are
  Box force;         ///< box of the nodes nearer than the force radius; may reach past the region
  int selector = 0;  ///< the force whose deformation box is this one's, for most the force itself
  int region = -1;   ///< which of the regions it acts in; -1: in none

  friend bool operator==(const ForceSelection&, const ForceSelection&) = default;
};

/// The region selection of thesis 5.3, fig. 5; SPEC 5.
struct Selection {
  Box region;                          ///< around all regions; empty: nothing is selected
  std::vector<ForceSelection> forces;  ///< in the order of the forces
  std::vector<Region> regions;         ///< as `combine` orders them, also those too small to solve

  friend bool operator==(const Selection&, const Selection&) = default;
};

/// What a force gives to the interior nodes of its region, all together. World [length b/uv^4]
struct Push {
  Vector3d sum = {0, 0, 0};  ///< of the loads on nodes
  int node_count = 0;        ///< nodes whose load is not 0
};

}  // namespace pliant
