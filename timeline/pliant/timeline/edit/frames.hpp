#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "pliant/core/result.hpp"
#include "pliant/timeline/number_text.hpp"

namespace pliant::timeline {

/// Why there are no frames from `first` to `last`; null: there are.
inline std::optional<Complaint> fault_of_frames(double first, double last) {
  for (const auto& [name, number] : {std::pair{"first", first}, std::pair{"last", last}}) {
    if (std::isfinite(number)) continue;
    return Complaint{
        0, std::string(name) + " is " + number_text(number) + "; it must be a finite frame"};
  }
  if (last < first) {
    return Complaint{0, "last is frame " + number_text(last) +
                            "; it must not come before first, frame " + number_text(first)};
  }
  return std::nullopt;
}

}  // namespace pliant::timeline
