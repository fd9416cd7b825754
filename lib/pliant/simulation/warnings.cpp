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

FrameRanges& WarningLog::frames_of(FramesOfCauses& causes, const CauseView& cause) {
  const auto found = causes.find(cause);
  if (found != causes.end()) return found->second;
  return causes[{cause.kind, std::string(cause.surface), std::string(cause.force)}];
}

void WarningLog::add(Warning::Kind kind, std::string_view surface, std::string_view force,
                     int frame) {
  frames_of(frames_, {kind, surface, force}).add(frame);
}

void WarningLog::expect(Warning::Kind kind, std::string_view surface, std::string_view force,
                        int frame) {
  frames_of(expected_, {kind, surface, force}).add(frame);
}

void WarningLog::happened(Warning::Kind kind, std::string_view surface, std::string_view force) {
  if (happened_.contains(CauseView{kind, surface, force})) return;
  happened_.insert({kind, std::string(surface), std::string(force)});
}

std::vector<Warning> WarningLog::warnings(bool is_range_complete) const {
  FramesOfCauses all = frames_;
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
