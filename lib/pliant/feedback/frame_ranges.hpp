#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace pliant {

/// A set of frames, stored as ranges.
class FrameRanges {
 public:
  /// Adds a frame; adding one twice changes nothing.
  void add(int frame);

  /// Adds all frames of `other`.
  void add(const FrameRanges& other);

  /// Text for an author: "3", "3-7, 12". With more than `most` ranges, only the first ones and a
  /// summary of the others: "3-7, 12 and 80 more ranges to 960". Requires: most >= 1.
  std::string to_string(std::size_t most = std::numeric_limits<std::size_t>::max()) const;

  const std::vector<std::pair<int, int>>& ranges() const { return ranges_; }

 private:
  std::vector<std::pair<int, int>> ranges_;  // first and last, ascending, never adjacent
};

}  // namespace pliant
