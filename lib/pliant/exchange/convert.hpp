#pragma once

#include <functional>
#include <string>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/exchange/segments.hpp"

namespace pliant::exchange {

/// What the curves of a format can be.
struct Abilities {
  bool has_steps = true;         ///< a segment may be constant beside others that are not
  bool has_step_next = false;    ///< and may have the next key's value
  bool has_left_values = false;  ///< a curve may arrive at a key with another value than it has
  bool has_long_arms = true;     ///< handles of any length; otherwise a segment is a cubic in time
  bool has_lines = true;         ///< straight lines beyond the keys
  bool lines_need_motion = false;   ///< but none beside a constant segment
  bool has_copies = true;           ///< endless copies
  bool has_counted_copies = false;  ///< `repeat` with a count, `mirror` with an even one
  std::function<bool(const Segment& easing)> has_easing = {};  ///< null: none
  double least_arm = 0;       ///< a handle must not be shorter than this share of its segment
  bool has_bold_arms = true;  ///< a handle may be longer than its segment
  double gap = 1.0 / 1024;    ///< how long a jump takes [frames]
};

/// What became of a part of a curve that a format cannot hold. One line: the thing, what it became.
struct Loss {
  std::string message;
  bool is_exact = false;  ///< the values of the curve are the same
};

/// A curve that a format can hold.
struct ConvertedCurve {
  Segments segments;
  std::vector<Loss> losses;  ///< one for each kind
};

/// The frames for which a curve without end is wanted.
struct WantedFrames {
  double first = 0;
  double last = 0;
};

/// Changes segments into those that a format can hold. Where it cannot hold the shape of one,
/// cubics in time replace it, which deviate by at most `tolerance` [unit], or by what is told if a
/// segment changes too fast for 1024 of them and for 16 a frame; jumps take `gap` frames; copies
/// become keys, endless ones as far as frames are wanted. Errors: numbers that no other program
/// computes with: frames beyond 1e7, keys closer than 1e-6 frames, values beyond 1e30; more than
/// `most_segments`. Interrupted.
Result<ConvertedCurve> convert(Segments segments, const Abilities& abilities, double tolerance,
                               WantedFrames wanted, const StopRequest& should_stop = {});

}  // namespace pliant::exchange
