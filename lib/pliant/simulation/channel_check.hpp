#pragma once

#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// Checks every channel at every integer frame of the scene's range against the rules of SPEC 2 and
/// 7: finite values; density, damping >= 0; b, d > 0; c > -2 sqrt(b d); dt > 0 and at most 10^5
/// steps a frame; radii >= 0; a transform that can be inverted. One error a channel, at its first
/// frame at fault, naming channel, frame and value. Requires: fps > 0, start <= end.
std::vector<Error> check_channels(const Scene& scene);

}  // namespace pliant
