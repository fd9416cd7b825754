#include "viewer/lines.hpp"

#include <array>
#include <string_view>
#include <type_traits>

#include "pliant/core/hash.hpp"

namespace pliant::viewer {
namespace {

// Distinguishes lines: the hash of all their numbers.
std::string name_of(const SurfaceLines& lines) {
  std::string bytes;
  const auto add = [&](const auto& numbers) {
    using Number = typename std::decay_t<decltype(numbers)>::value_type;
    const auto count = static_cast<std::uint64_t>(numbers.size());
    bytes.append(reinterpret_cast<const char*>(&count), sizeof(count));
    bytes.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number));
  };
  add(lines.starts);
  add(lines.sources);
  add(lines.shares);
  add(lines.segments);
  return to_text(hash_of(bytes));
}

}  // namespace

Json PackedLines::add(const SurfaceLines& lines) {
  const auto [found, is_new] = places_.try_emplace(name_of(lines));
  Json& place = found->second;
  if (!is_new) return place;
  place = {counts_.size(), lines.point_count(), segments_.size() / 2, lines.segments.size()};
  for (int point = 0; point < lines.point_count(); ++point) {
    counts_.push_back(static_cast<std::uint32_t>(lines.starts[point + 1] - lines.starts[point]));
  }
  sources_.insert(sources_.end(), lines.sources.begin(), lines.sources.end());
  for (const double share : lines.shares) shares_.push_back(static_cast<float>(share));
  for (const std::array<int, 2>& segment : lines.segments) {
    for (const int point : segment) segments_.push_back(static_cast<std::uint32_t>(point));
  }
  return place;
}

Json PackedLines::arrays(Arrays& arrays) const {
  return {{"counts", arrays.add(counts_)},
          {"sources", arrays.add(sources_)},
          {"shares", arrays.add(shares_)},
          {"segments", arrays.add(segments_)}};
}

}  // namespace pliant::viewer
