#pragma once

#include <compare>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/simulation/warnings.hpp"

namespace pliant {

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
