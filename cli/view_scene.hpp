#pragma once

#include "frame_range.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/simulation/frame_store.hpp"
#include "view.hpp"
#include "view_bake.hpp"

namespace pliant::cli {

/// A scene that has been run for a page.
struct BakedScene {
  Scene scene;
  FrameRange frames;
  ViewBake bake;
  FrameCounts counts;  ///< how many of its frames were solved, and how many read
};

/// What the page is called: the scene's file, without its folder.
std::string title_of(const Scene& scene);

/// Runs a scene that has been read, and prints its notes and warnings. Errors: those of
/// `parse_frames`, of the simulation and of `view_bake`. What an earlier run left in `store` is not
/// solved again; its memory is part of what the command may use.
Result<BakedScene> bake_scene(Scene scene, const ViewOptions& options,
                              const StopRequest& should_stop, MemoryFrameStore* store = nullptr);

}  // namespace pliant::cli
