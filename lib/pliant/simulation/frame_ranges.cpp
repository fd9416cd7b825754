#include "pliant/simulation/frame_ranges.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace pliant {

void FrameRanges::add(int frame) {
  // The first range that ends at frame - 1 or later is the only one that may hold or touch it from
  // the left; the one after it may touch from the right.
  auto range = std::lower_bound(ranges_.begin(), ranges_.end(), frame - 1,
                                [](const auto& r, int f) { return r.second < f; });
  if (range == ranges_.end() || frame + 1 < range->first) {
    ranges_.insert(range, {frame, frame});
    return;
  }
  range->first = std::min(range->first, frame);
  range->second = std::max(range->second, frame);
  const auto next = std::next(range);
  if (next != ranges_.end() && next->first <= range->second + 1) {
    range->second = std::max(range->second, next->second);
    ranges_.erase(next);
  }
}

std::string FrameRanges::to_string() const {
  std::string text;
  for (const auto& [first, last] : ranges_) {
    if (!text.empty()) text += ", ";
    text += first == last ? fmt::to_string(first) : fmt::format("{}-{}", first, last);
  }
  return text;
}

}  // namespace pliant
