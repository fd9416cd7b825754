#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pliant::timeline {

/// Finds the segment of a frame. As many buckets as keys, evenly spread over time, limit the
/// search: one step for evenly spaced keys, O(log keys) for any keys.
class KeySearch {
 public:
  KeySearch() = default;

  /// Requires: frames strictly increasing, at least one, at most 2^31.
  explicit KeySearch(const std::vector<double>& frames);

  /// The last key at or before a frame, except the very last key. Requires: `frames` is that of the
  /// constructor, frames.front() <= frame. Otherwise returns some valid index.
  std::size_t segment_at(const std::vector<double>& frames, double frame) const {
    const std::size_t bucket = bucket_of(frame);
    // Keys of earlier buckets are before the frame, those of later ones after it, because bucket_of
    // is non-decreasing.
    const double* base = frames.data() + reach_[bucket];
    for (std::size_t count = 1 + reach_[bucket + 1] - reach_[bucket]; count > 1;) {
      const std::size_t half = count / 2;
      base += base[half] <= frame ? half : 0;
      count -= half;
    }
    const auto key = static_cast<std::size_t>(base - frames.data());
    return std::min(key, last_segment_);
  }

 private:
  std::size_t bucket_of(double frame) const {
    const double position = (frame - first_) * buckets_per_frame_;
    // Written so that NaN, as a frame at infinity may give, counts as 0.
    const double clamped = position > 0 ? std::min(position, last_bucket_) : 0;
    return static_cast<std::size_t>(static_cast<std::int64_t>(clamped));
  }

  double first_ = 0;
  double buckets_per_frame_ = 0;
  double last_bucket_ = 0;
  std::size_t last_segment_ = 0;
  std::vector<std::uint32_t> reach_ = {0,
                                       0};  // the last key before each bucket, and before the end
};

}  // namespace pliant::timeline
