#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant {

/// What a boxed program finds open: its input at 0, to be read; /dev/null at 1 and 2; a pipe for
/// its answer at 3.
inline constexpr int boxed_input = 0;
inline constexpr int boxed_answer = 3;
inline constexpr int boxed_program = 4;  ///< itself, until `enter_box`

/// How a boxed program ends that has given its answer, or that has no memory for it.
inline constexpr int boxed_done = 0;
inline constexpr int boxed_out_of_memory = 4;

/// What a boxed program may take.
struct BoxLimits {
  std::size_t memory = 0;        ///< of its address space [bytes]
  double seconds = 0;            ///< by the clock, and of processor time
  std::size_t answer_bytes = 0;  ///< of its answer

  /// What its memory is filled with where it is freed, and with the complement where it is fresh;
  /// not 0. A program that reads either answers otherwise with another one.
  unsigned char freed = 0xff;
};

/// How a program in a box ended, and what it answered until then.
struct BoxedEnd {
  enum class How {
    Exited,    ///< `number` is its exit code
    Killed,    ///< by the signal `number`: it crashed
    TimedOut,  ///< it took longer than it may
    TooLong,   ///< its answer was longer than it may be
  };
  How how = How::Exited;
  int number = 0;
  std::string answer;
};

/// Runs a program that is handed bytes nobody vouches for, in a process of its own: `program` is
/// the file's bytes, so that nothing has to be found on the disk, and begins with `enter_box`,
/// which takes away all that it does not need. It sees nothing of this process but `arguments`, the
/// open file `input` and the pipe. When the call returns, or this process dies, it is gone.
///
/// `should_stop` is asked twenty times a second. Any number of threads may run programs at once.
/// Errors: Unreadable where the system starts no process; Interrupted.
Result<BoxedEnd> run_boxed(std::string_view program, const std::vector<std::string>& arguments,
                           int input, const BoxLimits& limits, const StopRequest& should_stop);

}  // namespace pliant
