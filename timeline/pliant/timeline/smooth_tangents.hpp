#pragma once

#include <vector>

#include "pliant/timeline/key_polyline.hpp"
#include "pliant/timeline/tangents.hpp"

namespace pliant::timeline {

/// The role of a side of a key in the system for continuous acceleration.
enum class SmoothKind { None, Free, Capped };

struct SmoothSides {
  std::vector<SmoothKind> in;
  std::vector<SmoothKind> out;
};

/// Replaces the slopes of `smooth` (Capped) and `free` sides by those that make the acceleration
/// continuous (docs/timeline.md, eq. 11 to 13); reads the slopes of the other sides.
void solve_smooth_tangents(const KeyPolyline& polyline, const SmoothSides& sides, Slopes& slopes);

}  // namespace pliant::timeline
