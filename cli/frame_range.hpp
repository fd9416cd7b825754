#pragma once

#include <optional>
#include <string>

#include "pliant/core/result.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant::cli {

/// A range of frames, both ends included.
struct FrameRange {
  int first = 0;
  int last = 0;

  int count() const { return last - first + 1; }
};

/// Parses A:B or one frame, within the scene's frames; null: all frames. Errors: InvalidInput,
/// naming --frames.
Result<FrameRange> parse_frames(const std::optional<std::string>& asked, const Scene& scene);

}  // namespace pliant::cli
