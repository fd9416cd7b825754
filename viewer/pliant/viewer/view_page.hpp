#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant {

/// What a page shows, and the limits of the run for it.
struct ViewPageOptions {
  std::optional<FrameSpan> frames = {};  ///< of the scene; none: all of them
  /// Of the simulation and what the page needs together. [bytes]
  std::size_t max_memory = std::numeric_limits<std::size_t>::max();
  StopRequest should_stop = {};
  /// Called after each frame from the scene's start on, up to the last that is shown.
  std::function<void()> frame_done = {};
};

/// The page of `pliant view`, which plays the simulation in a browser: one text that needs no
/// network. Its bytes are those of the command for the same scene and frames. Runs the simulation
/// from the scene's start.
///
/// Errors: those of `Simulation::at`; InvalidInput for frames that the scene does not have;
/// OutOfMemory, before the run, if the frames need more memory than allowed, and if the page would
/// be larger than browsers can load; Unwritable if this build has no page; Interrupted.
Result<std::string> view_page(Simulation& simulation, const ViewPageOptions& options = {});

/// Writes the page to a file, which appears whole or not at all. Errors: further Unwritable.
Result<void> write_view_page(Simulation& simulation, const std::string& file,
                             const ViewPageOptions& options = {});

}  // namespace pliant
