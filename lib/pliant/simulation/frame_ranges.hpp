#pragma once

#include <string>
#include <utility>
#include <vector>

namespace pliant {

/// A set of frames, kept as ranges.
class FrameRanges {
 public:
  /// Adds a frame; adding one twice changes nothing.
  void add(int frame);

  /// As an author reads it: "3", "3-7, 12".
  std::string to_string() const;

  const std::vector<std::pair<int, int>>& ranges() const { return ranges_; }

 private:
  std::vector<std::pair<int, int>> ranges_;  // first and last, ascending, never adjacent
};

}  // namespace pliant
