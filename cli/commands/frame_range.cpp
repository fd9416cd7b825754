#include "cli/commands/frame_range.hpp"

#include <fmt/format.h>

#include "pliant/core/text.hpp"

namespace pliant::cli {

Result<FrameSpan> parse_frame_range(const std::string& text) {
  const std::size_t colon = text.find(':');
  const auto first = to_integer(text.substr(0, colon));
  const auto last = colon == std::string::npos ? first : to_integer(text.substr(colon + 1));
  if (first && last && *first <= *last) return FrameSpan{*first, *last};
  return fail(ErrorCode::InvalidInput,
              fmt::format("--frames {}: must be one frame, or A:B with A <= B", text));
}

Result<FrameSpan> parse_frames(const std::optional<std::string>& asked, const Scene& scene) {
  if (!asked) return FrameSpan{scene.start, scene.end};
  auto frames = parse_frame_range(*asked);
  if (!frames) return frames;
  if (frames->first < scene.start || frames->last > scene.end) {
    return fail(ErrorCode::InvalidInput, fmt::format("--frames {}: the scene has frames {} to {}",
                                                     *asked, scene.start, scene.end));
  }
  return frames;
}

std::string peak_text(double peak_displacement, const FrameSpan& frames, const Scene& scene) {
  std::string text = fmt::format("peak displacement {:.6g}", peak_displacement);
  if (frames.first == scene.start && frames.last == scene.end) return text;
  return text + (frames.count() == 1
                     ? fmt::format(" at frame {}", frames.first)
                     : fmt::format(" in frames {} to {}", frames.first, frames.last));
}

}  // namespace pliant::cli
