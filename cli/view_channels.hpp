#pragma once

#include <nlohmann/json.hpp>

#include "frame_range.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant::cli {

/// The animated channels of a scene for the page's curve panel: keys, handles, and the curve as
/// points, over the frames given.
nlohmann::ordered_json view_channels(const Scene& scene, const FrameRange& frames);

}  // namespace pliant::cli
