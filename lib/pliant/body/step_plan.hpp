#pragma once

#include <optional>
#include <vector>

#include "pliant/plate/time_steps.hpp"
#include "pliant/region/selection.hpp"
#include "pliant/region/triangles/triangle_selection.hpp"

namespace pliant {

/// What one step of a body does, decided before it solves: for the step itself, and for all that
/// tell of it.
struct StepPlan {
  Selection selection;  ///< of the forces, in the order of the inputs, and of `recovering`
  std::optional<TriangleSelection> surface;  ///< the same on a surface of triangles; null: a grid
  bool is_whole = false;                     ///< all is solved, whatever the forces select
  TimeSteps steps;                           ///< of the solve
  std::vector<int> recovering;  ///< nodes solved because they are not back at rest, ascending
  std::vector<int> settling;    ///< nodes put at rest before the solve, ascending

  bool selects() const;       ///< whether there is a region, even one that is not solved
  bool solves() const;        ///< whether any node moves
  int unknown_count() const;  ///< nodes that move, of all patches
  bool is_held() const;       ///< false: nothing holds a patch that moves
};

}  // namespace pliant
