#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// Which channels to check, by the name of their surface or force and their attribute. Empty: all.
using ChannelFilter = std::function<bool(const std::string& name, std::string_view attribute)>;

/// Checks every channel at every integer frame of the scene's range against the rules of SPEC 2 and
/// 7: finite values; density, damping >= 0; b, d > 0; c > -2 sqrt(b d); dt > 0 and at most 10^5
/// steps a frame; radii, frequency and rate >= 0; progress within 0 to 1; a transform that can be
/// inverted. One error a channel, at its first frame at fault, naming channel, frame and value. c
/// is checked where b and d are, and keep their rules. `should_stop` is asked for each channel;
/// what was not looked at is then not told of. Requires: fps > 0, start <= end.
std::vector<Error> check_channels(const Scene& scene, const ChannelFilter& is_checked = {},
                                  const StopRequest& should_stop = {});

}  // namespace pliant
