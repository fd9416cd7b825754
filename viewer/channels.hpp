#pragma once

#include "pliant/core/stop_request.hpp"
#include "pliant/scene/scene.hpp"
#include "viewer/json.hpp"

namespace pliant::viewer {

/// The animated channels of a scene for the page's curve panel: keys, handles, and the curve as
/// points, over `frames`. Errors: Interrupted.
Result<Json> view_channels(const Scene& scene, const FrameSpan& frames,
                           const StopRequest& should_stop = {});

}  // namespace pliant::viewer
