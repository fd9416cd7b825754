#pragma once

#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/region/selection.hpp"
#include "pliant/region/triangles/level_set.hpp"
#include "pliant/region/triangles/triangle_cut.hpp"

namespace pliant {

/// One force in the selection of a frame on a surface.
struct TriangleForceSelection {
  bool selects = false;       ///< whether it has a region of its own
  bool is_near = false;       ///< whether its sphere reaches a face, with or without a node in it
  CutCounts counts;           ///< nodes nearer than its deformation radius, cells at them
  bool acts_inside = false;   ///< whether it acts on the area of a node that moves
  bool acts_outside = false;  ///< whether any node is nearer than its force radius, if not inside
  bool is_lost = false;       ///< whether it acts on the surface at rest, but not now
  Push push;                  ///< its effect on the nodes that move
};

/// The region of a frame on a surface.
struct TriangleSelection {
  LevelSet level_set;  ///< snapped, and extended to nodes that recover
  std::vector<TrianglePatch> patches;
  std::vector<Field> loads;  ///< of each patch (#free_nodes x 3, world): see `TriangleLoads`
  std::vector<TriangleForceSelection> forces;  ///< in the order of the forces
};

}  // namespace pliant
