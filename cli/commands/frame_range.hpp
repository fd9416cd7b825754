#pragma once

#include <optional>
#include <string>

#include "pliant/core/result.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant::cli {

/// Parses A:B or one frame. Errors: InvalidInput, naming --frames.
Result<FrameSpan> parse_frame_range(const std::string& text);

/// Parses A:B or one frame, within the scene's frames; null: all frames. Errors: InvalidInput,
/// naming --frames.
Result<FrameSpan> parse_frames(const std::optional<std::string>& asked, const Scene& scene);

/// The end of a summary, "peak displacement 1.58", and of which frames it is unless they are all.
std::string peak_text(double peak_displacement, const FrameSpan& frames, const Scene& scene);

}  // namespace pliant::cli
