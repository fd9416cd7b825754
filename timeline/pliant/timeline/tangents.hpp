#pragma once

#include <vector>

#include "pliant/core/stop_request.hpp"
#include "pliant/timeline/key.hpp"
#include "pliant/timeline/key_polyline.hpp"

namespace pliant::timeline {

/// The slopes of one component on both sides of every key [unit/frame].
struct Slopes {
  std::vector<double> in;
  std::vector<double> out;
  bool is_stopped = false;  ///< then they are of no use
};

/// The slopes of the tangents of component c (docs/timeline.md, eq. 7 to 13). The slope of a handle
/// is its value over its time, 0 if its time is 0 or points backwards. Slopes overflow if keys are
/// too close for their change of value; the caller checks. Requires: at least one key, frames
/// strictly increasing.
template <int D>
Slopes tangent_slopes(const std::vector<Key<D>>& keys, const Extrapolation<D>& before,
                      const Extrapolation<D>& after, int c, const StopRequest& should_stop = {});

extern template Slopes tangent_slopes(const std::vector<Key<1>>&, const Extrapolation<1>&,
                                      const Extrapolation<1>&, int, const StopRequest&);
extern template Slopes tangent_slopes(const std::vector<Key<3>>&, const Extrapolation<3>&,
                                      const Extrapolation<3>&, int, const StopRequest&);

/// The role of a side of a key in the system for continuous acceleration.
enum class SmoothKind { None, Free, Capped };

struct SmoothSides {
  std::vector<SmoothKind> in;
  std::vector<SmoothKind> out;
};

/// Replaces the slopes of `smooth` (Capped) and `free` sides by those that make the acceleration
/// continuous (docs/timeline.md, eq. 11 to 13); reads the slopes of the other sides.
void solve_smooth_tangents(const KeyPolyline& polyline, const SmoothSides& sides, Slopes& slopes,
                           const StopRequest& should_stop);

}  // namespace pliant::timeline
