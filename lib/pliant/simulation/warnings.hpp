#pragma once

#include <compare>
#include <map>
#include <set>
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
  };
  Kind kind = Kind::RegionTooSmall;
  std::string surface;  ///< empty: any, of a force that selects nothing anywhere
  std::string force;    ///< empty: the surface itself is meant
  FrameRanges frames;

  /// One line for an author, frames included.
  std::string message() const;
};

/// Warnings gathered by cause, each with all its frames.
class WarningLog {
 public:
  void add(Warning::Kind kind, const std::string& surface, const std::string& force, int frame);

  /// Something that should happen in some frame of the range and may in this one. It is a warning
  /// with all these frames when it `happened` in none.
  void expect(Warning::Kind kind, const std::string& surface, const std::string& force, int frame);
  void happened(Warning::Kind kind, const std::string& surface, const std::string& force);

  /// In order of kind, surface and force. What never happened is told once the range is complete.
  std::vector<Warning> warnings(bool is_range_complete) const;

 private:
  struct Cause {
    Warning::Kind kind;
    std::string surface;
    std::string force;
    friend auto operator<=>(const Cause&, const Cause&) = default;
  };
  std::map<Cause, FrameRanges> frames_;
  std::map<Cause, FrameRanges> expected_;
  std::set<Cause> happened_;
};

}  // namespace pliant
