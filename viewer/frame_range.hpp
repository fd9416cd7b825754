#pragma once

namespace pliant::viewer {

/// A range of frames, both ends included.
struct FrameRange {
  int first = 0;
  int last = 0;

  int count() const { return last - first + 1; }
};

}  // namespace pliant::viewer
