#pragma once

#include <chrono>

#include "pliant/core/profile.hpp"

namespace pliant {

/// Adds the time from here to the end of its scope to one stage; null profile: does nothing. Not
/// thread-safe: a profile is for one thread.
class StageTimer {
 public:
  StageTimer(Profile* profile, Stage stage) : profile_(profile), stage_(stage) {
    if (profile_) begin_ = Clock::now();
  }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;
  ~StageTimer() { stop(); }

  /// Stops before the end of the scope.
  void stop() {
    if (!profile_) return;
    (*profile_)[stage_] += std::chrono::duration<double>(Clock::now() - begin_).count();
    profile_ = nullptr;
  }

 private:
  using Clock = std::chrono::steady_clock;

  Profile* profile_;
  Stage stage_;
  Clock::time_point begin_ = {};
};

}  // namespace pliant
