#pragma once

#include "cli/commands/frame_range.hpp"
#include "cli/view/view.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/states/state_store.hpp"
#include "viewer/bake.hpp"

namespace pliant::cli {

/// A scene after its run for a page.
struct BakedScene {
  Scene scene;
  FrameSpan frames;
  viewer::ViewBake bake;
  FrameCounts counts;  ///< frames solved and frames read from the store
};

viewer::ViewLimits view_limits(const ViewOptions& options, const StopRequest& should_stop);

/// Runs a scene that has been read, and prints its notes and warnings. States of earlier runs in
/// `store` are not solved again; the memory of the store counts towards the command's limit.
/// Errors: those of `parse_frames`, of the simulation and of `view_bake`.
Result<BakedScene> bake_scene(Scene scene, const ViewOptions& options,
                              const StopRequest& should_stop, MemoryStateStore* store = nullptr);

}  // namespace pliant::cli
