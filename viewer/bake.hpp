#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "pliant/simulation/simulation.hpp"
#include "viewer/telling_frames.hpp"

namespace pliant::viewer {

/// The data of a page.
struct ViewBake {
  std::string packed;  ///< a raw deflate stream; docs/viewer.md describes its content [bytes]
  int vertex_count = 0;
  double peak_displacement = 0;    ///< of its frames, world [length]
  std::size_t position_bytes = 0;  ///< of the frames once unpacked [bytes]
  MotionCourse course;             ///< of its frames
};

/// Limits of a run for a page.
struct ViewLimits {
  std::size_t max_memory = 0;  ///< of the simulation and the frames together [bytes]
  StopRequest should_stop = {};
  std::string advice = "choose fewer frames";  ///< to those for whose scene a page is too large
};

/// Runs the simulation from the scene's start, and packs `frames` for a page. `advance` is called
/// after each frame. Errors: those of the simulation; OutOfMemory, before the run, if the frames
/// need more memory than allowed; Interrupted.
Result<ViewBake> view_bake(Simulation& simulation, const FrameSpan& frames,
                           const ViewLimits& limits, const std::function<void()>& advance);

/// A self-contained page: `page_with` of the bake, with the name of the scene's file, without its
/// folder, in the title. Errors: OutOfMemory if it is larger than browsers can load; Interrupted.
Result<std::string> page_of(std::string_view page, const Scene& scene, const ViewBake& bake,
                            const ViewLimits& limits);

/// Above this size a page may start slowly or fail in a browser. [bytes of positions]
inline constexpr std::size_t heavy_positions = 200'000'000;

}  // namespace pliant::viewer
