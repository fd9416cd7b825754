#pragma once

#include "frame_range.hpp"
#include "json.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant::cli {

/// The animated channels of a scene for the page's curve panel: keys, handles, and the curve as
/// points, over `frames`.
Json view_channels(const Scene& scene, const FrameRange& frames);

}  // namespace pliant::cli
