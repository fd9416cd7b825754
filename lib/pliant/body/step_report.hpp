#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pliant/plate/time_steps.hpp"
#include "pliant/region/region.hpp"

namespace pliant {

/// The selection, solve and warnings of a frame.
struct StepReport {
  Selection selection;  ///< the forces' selection, in the order of the inputs, and its regions
  std::vector<std::vector<Patch>> patches;  ///< of each region; empty: it is too small to solve
  bool is_solved = false;                   ///< whether there is any unknown
  TimeSteps steps;                          ///< of the solve
  std::vector<int> lost;  ///< forces that select nodes on the rest mesh, but none now
  std::vector<bool>
      pushing;         ///< of each force: whether it moves any node; in the order of the inputs
  int recovering = 0;  ///< nodes that are solved because they are not back at rest
  std::vector<int> settling;  ///< nodes that are put at rest before the solve, ascending

  int unknown_count() const;  ///< nodes that move, of all patches

  /// The patches that force k of the inputs acts in.
  std::span<const Patch> patches_of_force(std::size_t k) const;
};

}  // namespace pliant
