#pragma once

#include <optional>
#include <string>

#include "pliant/core/result.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant::cli {

/// Frames that are asked for, both ends included.
struct FrameRange {
  int first = 0;
  int last = 0;

  int count() const { return last - first + 1; }
};

/// A:B, or one frame, within the scene's frames; all of them when nothing is asked for. Errors:
/// InvalidInput, naming --frames.
Result<FrameRange> parse_frames(const std::optional<std::string>& asked, const Scene& scene);

}  // namespace pliant::cli
