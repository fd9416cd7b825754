#pragma once

#include <string>
#include <vector>

#include "pliant/simulation/frame_ranges.hpp"

namespace pliant {

/// Something that a run met and an author would want to know; the run goes on.
struct Warning {
  enum class Kind {
    RegionTooSmall,  ///< fewer than 3 x 3 nodes selected: not solved
    LostNodes,       ///< a force holds nodes of the rest mesh, but none as it stands
    OutsideRegion,   ///< a force with a magnitude has its box outside the solved region
    SelectsNothing,  ///< an enabled force touches no node in the whole range
    PushesNothing,   ///< a force with a magnitude pushes no node that moves, in the whole range
    NeverStarts,     ///< the surface's start frame is behind the last frame that is solved
    TangentsUnused,  ///< tangents other than 0, but no region is solved in the whole range
    ForcesApart,     ///< boxes that do not meet make one region, since `combine` is box
  };
  Kind kind = Kind::RegionTooSmall;
  std::string surface;  ///< empty: any, of a force that selects nothing anywhere
  std::string force;    ///< or group; empty: the surface itself is meant
  FrameRanges frames;
  std::vector<std::string> others = {};  ///< of forces that are apart: those besides `force`
  bool is_group = false;                 ///< whether `force` is the region of a group

  /// One line for an author, frames included.
  std::string message() const;
};

}  // namespace pliant
