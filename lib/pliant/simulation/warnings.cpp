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
  }
  return {};
}

void WarningLog::add(Warning::Kind kind, const std::string& surface, const std::string& force,
                     int frame) {
  frames_[{kind, surface, force}].add(frame);
}

std::vector<Warning> WarningLog::warnings() const {
  std::vector<Warning> warnings;
  for (const auto& [cause, frames] : frames_) {
    warnings.push_back({cause.kind, cause.surface, cause.force, frames});
  }
  return warnings;
}

}  // namespace pliant
