#pragma once

#include <optional>
#include <vector>

#include "pliant/core/stop_request.hpp"
#include "pliant/exchange/segments.hpp"

namespace pliant::exchange {

/// Bézier segments in place of one, whose key they have.
struct Cubics {
  std::vector<Segment> segments = {};
  double deviation = 0;   ///< the largest between them and the segment [unit]
  bool are_close = true;  ///< within the tolerance
};

/// Those of an easing that consists of cubics; null: it does not.
std::optional<std::vector<Segment>> exact_cubics(const Segment& segment);

/// A circ easing, a quarter of an ellipse, as Bézier arcs; two quarters for InOut. Source: Riškus,
/// Approximation of a cubic Bézier curve by circular arcs and vice versa: handles of
/// 4/3·tan(angle/4).
Cubics arcs_of(const Segment& segment, double tolerance);

/// Cubics in time: at most 1024, or 16 a frame. More are of no use to anyone who looks at it, such
/// as those of an elastic with many periods in each frame. Null: it was stopped.
std::optional<Cubics> fitted_cubics(const Segment& segment, double tolerance,
                                    const StopRequest& should_stop);

/// The largest difference of values between a segment and others in its place [unit].
double deviation_of(const std::vector<Segment>& parts, const Segment& segment);

}  // namespace pliant::exchange
