#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "cli/terminal/progress.hpp"
#include "pliant/sweep/watch.hpp"

namespace pliant::cli {

/// Shows on a terminal how far the takes of a job are while it is waited for.
class WaitingBar {
 public:
  /// For the takes that are true, `count` of them, of the sweep in a folder. Begins before a job
  /// runs.
  WaitingBar(const std::string& folder, std::vector<bool> takes, std::size_t count, bool is_quiet);

  /// To be called often: looks at the log now and then. `is_running`: the job has begun.
  void look(bool is_running);

 private:
  using Clock = std::chrono::steady_clock;

  std::optional<SweepWatch> watch_;  // null: nothing is shown
  Progress progress_;
  bool has_begun_ = false;
  Clock::time_point next_ = {};
};

}  // namespace pliant::cli
