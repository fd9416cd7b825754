#include "pliant/timeline/key_search.hpp"

namespace pliant::timeline {

KeySearch::KeySearch(const std::vector<double>& frames) : first_(frames.front()) {
  const std::size_t buckets = frames.size();
  const double span = frames.back() - frames.front();
  // If keys are so close that this overflows, all but the first share the last bucket.
  buckets_per_frame_ = span > 0 ? static_cast<double>(buckets) / span : 0;
  last_bucket_ = static_cast<double>(buckets - 1);
  last_segment_ = frames.size() > 1 ? frames.size() - 2 : 0;
  reach_.assign(buckets + 1, 0);
  std::uint32_t key = 0;
  for (std::size_t bucket = 0; bucket < buckets; ++bucket) {
    reach_[bucket] = key == 0 ? 0 : key - 1;
    while (key < frames.size() && bucket_of(frames[key]) == bucket) ++key;
  }
  reach_[buckets] = static_cast<std::uint32_t>(frames.size() - 1);
}

}  // namespace pliant::timeline
