#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant {

/// Open descriptors of a sandboxed program: its input at 0, read-only; /dev/null at 1 and 2; a pipe
/// for its answer at 3.
inline constexpr int boxed_input = 0;
inline constexpr int boxed_answer = 3;
inline constexpr int boxed_program = 4;  ///< its own executable, until `enter_box`

/// Exit codes of a sandboxed program: it wrote its answer; it had too little memory.
inline constexpr int boxed_done = 0;
inline constexpr int boxed_out_of_memory = 4;

/// Limits of a sandboxed program.
struct BoxLimits {
  std::size_t memory = 0;        ///< of its address space [bytes]
  double seconds = 0;            ///< of wall-clock time, and of processor time
  std::size_t answer_bytes = 0;  ///< of its answer

  /// Fills freed memory with this byte, and new memory with its complement; not 0. A program that
  /// reads either gives another answer for another byte.
  unsigned char freed = 0xff;
};

/// How a sandboxed program ended, and its answer until then.
struct BoxedEnd {
  enum class How {
    Exited,    ///< `number` is its exit code
    Killed,    ///< by the signal `number`: it crashed
    TimedOut,  ///< it exceeded its time limit
    TooLong,   ///< its answer was longer than allowed
  };
  How how = How::Exited;
  int number = 0;
  std::string answer;
};

/// Runs a program on untrusted bytes in a process of its own. `program` is the bytes of an
/// executable, so that no file is needed on the disk; it begins with `enter_box`, which gives up
/// all rights that it does not need. It sees nothing of this process except `arguments`, the open
/// file `input` and the pipe. When the call returns, or this process dies, it is killed.
///
/// `should_stop` is called twenty times a second. Thread-safe. Errors: Unreadable if the system
/// cannot start the process; Interrupted.
Result<BoxedEnd> run_boxed(std::string_view program, const std::vector<std::string>& arguments,
                           int input, const BoxLimits& limits, const StopRequest& should_stop);

}  // namespace pliant
