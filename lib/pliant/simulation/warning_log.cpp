#include "pliant/simulation/warning_log.hpp"

namespace pliant {

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
    if (cause.kind == Warning::Kind::ForcesApart && !warnings.empty() &&
        warnings.back().kind == cause.kind && warnings.back().surface == cause.surface) {
      warnings.back().others.push_back(cause.force);
      warnings.back().frames.add(frames);
      continue;
    }
    warnings.push_back({cause.kind, cause.surface, cause.force, frames});
  }
  return warnings;
}

}  // namespace pliant
