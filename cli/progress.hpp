#pragma once

#include <chrono>

namespace pliant::cli {

/// A bar on stderr with frames, frames per second and time left; not shown if stderr is not a
/// terminal.
class Progress {
 public:
  Progress(int frame_count, bool is_quiet);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();  ///< erases the bar

  /// Counts one more frame. Draws at most ten times a second.
  void advance();

 private:
  using Clock = std::chrono::steady_clock;

  void draw_bar(Clock::time_point now) const;

  int frame_count_;
  int done_ = 0;
  bool is_shown_;
  Clock::time_point begin_ = Clock::now();
  Clock::time_point drawn_ = {};
};

}  // namespace pliant::cli
