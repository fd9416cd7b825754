#pragma once

#include <compare>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/body/step_facts.hpp"
#include "pliant/feedback/warnings.hpp"
#include "pliant/sampling/sampling.hpp"

namespace pliant {

/// Collects warnings by cause, each with all its frames.
class WarningLog {
 public:
  /// `other`: of the two colliders that squeeze something.
  void add(Warning::Kind kind, std::string_view surface, std::string_view force, int frame,
           std::string_view other = {});

  /// Nodes inside a collider, if there are some.
  void add_inside(Warning::Kind kind, std::string_view surface, std::string_view collider,
                  int frame, const NodesInside& inside);

  /// Notes that something is expected to happen at some frame of the range, perhaps this one. If it
  /// `happened` at none so far, it is a warning with all these frames.
  void expect(Warning::Kind kind, std::string_view surface, std::string_view force, int frame);
  void happened(Warning::Kind kind, std::string_view surface, std::string_view force);

  /// In the order of kind, surface and force. What is expected, but did not happen, is told as of
  /// the frames so far unless the range is complete. All forces that are apart on one surface form
  /// one warning, and none if the scene's file gives `combine`.
  std::vector<Warning> warnings(const Scene& scene, bool is_range_complete) const;

 private:
  struct CauseView {
    Warning::Kind kind;
    std::string_view surface;
    std::string_view force;
    std::string_view other = {};
    // NOLINTNEXTLINE(modernize-use-nullptr): not a pointer, but the 0 that <=> compares with
    friend auto operator<=>(const CauseView&, const CauseView&) = default;
  };
  struct Cause {
    Warning::Kind kind;
    std::string surface;
    std::string force;
    std::string other = {};
    operator CauseView() const { return {kind, surface, force, other}; }
  };
  // Finds a cause without copying its names.
  struct Before {
    using is_transparent = void;
    bool operator()(const CauseView& a, const CauseView& b) const { return a < b; }
  };
  using FramesOfCauses = std::map<Cause, FrameRanges, Before>;

  static FrameRanges& frames_of(FramesOfCauses& causes, const CauseView& cause);

  FramesOfCauses frames_;
  FramesOfCauses expected_;
  std::set<Cause, Before> happened_;
  std::map<Cause, NodesInside, Before> inside_;
};

/// Adds the facts of one surface's step at a frame.
void add_facts(WarningLog& log, const Surface& surface, int frame, const SurfaceInputs& inputs,
               const StepFacts& facts);

/// Adds those of its contacts, which have come to be at the next frame.
void add_contacts(WarningLog& log, const Scene& scene, const Surface& surface, int frame,
                  const std::vector<ContactFacts>& contacts);

}  // namespace pliant
