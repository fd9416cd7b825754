#include "pliant/simulation/warnings.hpp"

#include <fmt/format.h>

namespace pliant {

std::string Warning::message() const {
  const bool is_single = frames.ranges().size() == 1 &&
                         frames.ranges().front().first == frames.ranges().front().second;
  const std::string when = (is_single ? "at frame " : "at frames ") + frames.to_string();
  switch (kind) {
    case Kind::RegionTooSmall:
      return fmt::format(
          "force \"{}\" selects fewer than 3 x 3 nodes of \"{}\", too few to solve, {}", force,
          surface, when);
    case Kind::LostNodes:
      return fmt::format(
          "force \"{}\" lost its own nodes on \"{}\" {}: they are out of its reach; "
          "measure=\"rest\" measures on the rest mesh",
          force, surface, when);
    case Kind::OutsideRegion:
      return fmt::format(
          "the force box of \"{}\" lies outside the region solved on \"{}\" {}: it pushes nothing",
          force, surface, when);
    case Kind::SelectsNothing:
      return fmt::format(
          "force \"{}\" selects no node of {} {}: none is nearer than its deformationRadius", force,
          surface.empty() ? "any surface" : fmt::format("\"{}\"", surface), when);
    case Kind::PushesNothing:
      return fmt::format(
          "the magnitude of \"{}\" has no effect on {} {}: no node that moves is in its force box, "
          "or its direction or falloff is 0 there",
          force, surface.empty() ? "any surface" : fmt::format("\"{}\"", surface), when);
    case Kind::NeverStarts:
      return fmt::format("surface \"{}\" is not solved {}: its startFrame comes later", surface,
                         when);
    case Kind::TangentsUnused:
      return fmt::format("the tangents of \"{}\" have no effect {}: no force selects a region",
                         surface, when);
  }
  return {};
}

void WarningLog::add(Warning::Kind kind, const std::string& surface, const std::string& force,
                     int frame) {
  frames_[{kind, surface, force}].add(frame);
}

void WarningLog::expect(Warning::Kind kind, const std::string& surface, const std::string& force,
                        int frame) {
  expected_[{kind, surface, force}].add(frame);
}

void WarningLog::happened(Warning::Kind kind, const std::string& surface,
                          const std::string& force) {
  happened_.insert({kind, surface, force});
}

std::vector<Warning> WarningLog::warnings(bool is_range_complete) const {
  std::map<Cause, FrameRanges> all = frames_;
  if (is_range_complete) {
    for (const auto& [cause, frames] : expected_) {
      if (!happened_.contains(cause)) all.emplace(cause, frames);
    }
  }
  std::vector<Warning> warnings;
  for (const auto& [cause, frames] : all) {
    warnings.push_back({cause.kind, cause.surface, cause.force, frames});
  }
  return warnings;
}

}  // namespace pliant
