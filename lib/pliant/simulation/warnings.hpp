#pragma once

#include <compare>
#include <map>
#include <string>
#include <vector>

#include "pliant/simulation/frame_ranges.hpp"

namespace pliant {

/// Something that a run met and an author would want to know; the run goes on.
struct Warning {
  enum class Kind {
    RegionTooSmall,  ///< fewer than 3 x 3 nodes selected: not solved
    LostNodes,       ///< a force holds nodes of the rest mesh, but none as it stands
  };
  Kind kind = Kind::RegionTooSmall;
  std::string surface;
  std::string force;
  FrameRanges frames;

  /// One line for an author, frames included.
  std::string message() const;
};

/// Warnings gathered by cause, each with all its frames.
class WarningLog {
 public:
  void add(Warning::Kind kind, const std::string& surface, const std::string& force, int frame);

  /// In order of kind, surface and force.
  std::vector<Warning> warnings() const;

 private:
  struct Cause {
    Warning::Kind kind;
    std::string surface;
    std::string force;
    friend auto operator<=>(const Cause&, const Cause&) = default;
  };
  std::map<Cause, FrameRanges> frames_;
};

}  // namespace pliant
