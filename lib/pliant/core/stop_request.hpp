#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "pliant/core/result.hpp"

namespace pliant {

/// Called now and then during long work; true: the caller wants the work to end. Empty: never stop.
using StopRequest = std::function<bool()>;

inline bool is_stopped(const StopRequest& should_stop) { return should_stop && should_stop(); }

/// The same in a loop over files, takes or values, which asks once in 256 rounds.
inline bool is_stopped(const StopRequest& should_stop, std::size_t round) {
  constexpr std::size_t rounds_between = 256;
  return round % rounds_between == 0 && is_stopped(should_stop);
}

/// The error of work that was stopped.
inline tl::unexpected<Error> interrupted() { return fail(ErrorCode::Interrupted, "interrupted"); }

/// `error`; an interruption is told with the frame that it came in.
inline Error with_frame(Error error, int frame) {
  if (error.code == ErrorCode::Interrupted)
    error.message = "interrupted at frame " + std::to_string(frame);
  return error;
}

/// Asks a StopRequest in a loop of small parts, once for many of them. It must outlive this.
class StopPoll {
 public:
  /// A part is some nanoseconds of work, such as a byte read.
  static constexpr std::size_t parts_between = std::size_t{1} << 18U;

  explicit StopPoll(const StopRequest& should_stop) : should_stop_(should_stop) {}

  /// Whether to end, after `parts` more. Remains true once it is.
  bool after(std::size_t parts = 1) {
    parts_ += parts;
    if (parts_ >= parts_between) {
      parts_ = 0;
      is_stopped_ = is_stopped_ || is_stopped(should_stop_);
    }
    return is_stopped_;
  }

 private:
  const StopRequest& should_stop_;
  std::size_t parts_ = 0;
  bool is_stopped_ = false;
};

}  // namespace pliant
