#pragma once

#include <compare>
#include <map>
#include <set>
#include <string>
#include <string_view>
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

/// Warnings gathered by cause, each with all its frames.
class WarningLog {
 public:
  void add(Warning::Kind kind, std::string_view surface, std::string_view force, int frame);

  /// Something that should happen in some frame of the range and may in this one. It is a warning
  /// with all these frames when it `happened` in none.
  void expect(Warning::Kind kind, std::string_view surface, std::string_view force, int frame);
  void happened(Warning::Kind kind, std::string_view surface, std::string_view force);

  /// In order of kind, surface and force. What never happened is told once the range is complete.
  /// Forces that are apart on one surface come as one warning. Which names are groups is not known
  /// here.
  std::vector<Warning> warnings(bool is_range_complete) const;

 private:
  struct CauseView {
    Warning::Kind kind;
    std::string_view surface;
    std::string_view force;
    friend auto operator<=>(const CauseView&, const CauseView&) = default;
  };
  struct Cause {
    Warning::Kind kind;
    std::string surface;
    std::string force;
    operator CauseView() const { return {kind, surface, force}; }
  };
  // Looks a cause up without a copy of its names.
  struct Before {
    using is_transparent = void;
    bool operator()(const CauseView& a, const CauseView& b) const { return a < b; }
  };
  using FramesOfCauses = std::map<Cause, FrameRanges, Before>;

  static FrameRanges& frames_of(FramesOfCauses& causes, const CauseView& cause);

  FramesOfCauses frames_;
  FramesOfCauses expected_;
  std::set<Cause, Before> happened_;
};

}  // namespace pliant
