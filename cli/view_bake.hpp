#pragma once

#include <functional>
#include <string>

#include "frame_range.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant::cli {

/// What a page is made of besides the page itself.
struct ViewBake {
  std::string packed;  ///< a raw deflate stream, laid out as docs/viewer.md tells [bytes]
  int vertex_count = 0;
  double peak_displacement = 0;    ///< world [length]
  std::size_t position_bytes = 0;  ///< of the frames once unpacked [bytes]
};

/// How far a run for a page may go.
struct ViewLimits {
  std::size_t max_memory = 0;  ///< of the simulation and the frames together [bytes]
  StopRequest should_stop = {};
};

/// Runs the simulation over `frames`, from the scene's start, and packs what a page shows of it.
/// `advance` is called after each frame. Errors: those of the simulation; OutOfMemory, ahead of the
/// run, where the frames take more than is allowed; Interrupted.
Result<ViewBake> view_bake(Simulation& simulation, const FrameRange& frames,
                           const ViewLimits& limits, const std::function<void()>& advance);

/// More than this makes a browser slow to start, or fail. [bytes of positions]
inline constexpr std::size_t heavy_positions = 200'000'000;

}  // namespace pliant::cli
