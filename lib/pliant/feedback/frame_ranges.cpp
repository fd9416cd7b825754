#include "pliant/feedback/frame_ranges.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"

namespace pliant {

void FrameRanges::add(int frame) {
  // Only the first range that ends at frame - 1 or later can contain the frame or touch it from the
  // left; the next range may touch it from the right.
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

void FrameRanges::add(const FrameRanges& other) {
  std::vector<std::pair<int, int>> all = ranges_;
  all.insert(all.end(), other.ranges_.begin(), other.ranges_.end());
  std::sort(all.begin(), all.end());
  ranges_.clear();
  for (const auto& [first, last] : all) {
    if (ranges_.empty() || ranges_.back().second + 1 < first) {
      ranges_.emplace_back(first, last);
    } else {
      ranges_.back().second = std::max(ranges_.back().second, last);
    }
  }
}

std::string FrameRanges::to_string(std::size_t most) const {
  PLIANT_EXPECTS(most >= 1);
  // A summary of a single range would be as long as the range.
  const bool is_all = ranges_.size() <= most || ranges_.size() - 1 == most;
  const std::size_t told = is_all ? ranges_.size() : most;
  std::string text;
  for (std::size_t k = 0; k < told; ++k) {
    const auto& [first, last] = ranges_[k];
    if (!text.empty()) text += ", ";
    text += first == last ? fmt::to_string(first) : fmt::format("{}-{}", first, last);
  }
  if (is_all) return text;
  return text +
         fmt::format(" and {} more ranges to {}", ranges_.size() - told, ranges_.back().second);
}

}  // namespace pliant
