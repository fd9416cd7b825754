#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// Selects the channels to check, by the name of their surface, force or group and by their
/// attribute. Empty: all.
using ChannelFilter = std::function<bool(const std::string& name, std::string_view attribute)>;

/// Checks every channel at every integer frame at which it is sampled against the rules of SPEC 2
/// and 7: finite values; density, damping >= 0; b, d > 0; c > -2 sqrt(b d); dt > 0 and at most 10^5
/// steps a frame; radii >= 0; progress within 0 to 1; a transform that can be inverted. At most one
/// error per channel, at the first frame that breaks its rule, with channel, frame and value. c is
/// checked only if b and d are checked and keep their rules. Once `should_stop` returns true,
/// nothing more is checked, and the only error is Interrupted. Requires: fps > 0, start <= end.
std::vector<Error> check_channels(const Scene& scene, const ChannelFilter& is_checked = {},
                                  const StopRequest& should_stop = {});

/// The same at one frame only.
std::vector<Error> check_channels_at(const Scene& scene, int frame,
                                     const ChannelFilter& is_checked = {});

/// A frame in which a surface has neither density nor damping.
struct StaticFrame {
  int frame = 0;
  bool is_animated = false;  ///< other frames may differ
};

/// The first frame of some in which a surface is solved as what is static, with a goal or without
/// one; none: there is no such frame, or it is not solved.
std::optional<StaticFrame> static_frame_of(const Scene& scene, const Surface& surface,
                                           const FrameSpan& frames, bool has_goal = false);

/// The error that nothing holds a static surface, or a part of it, such as "the piece with vertex
/// 3"; empty: all of a grid.
Error not_held(const Scene& scene, const Surface& surface, const StaticFrame& at,
               std::string_view part);

}  // namespace pliant
