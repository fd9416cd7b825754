#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <sys/types.h>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/files/open_file.hpp"

namespace pliant::cli {

/// The absolute path of a program on the PATH; null: there is none of that name.
std::optional<std::string> program_on_path(std::string_view program);
inline bool is_on_path(std::string_view program) { return program_on_path(program).has_value(); }

/// The two ends of a pipe, which no program that is started gets by itself.
struct Pipe {
  OpenDescriptor reading, writing;

  bool open();  ///< false, with errno: there can be none
};

/// The standard streams of a program that is started: open descriptors, or /dev/null.
struct ChildStreams {
  int input = -1;  ///< -1: /dev/null
  int output = -1;
  int errors = -1;
  int lifeline = -1;        ///< becomes `lifeline_end` of the program; -1: none
  std::string folder = {};  ///< its working folder; empty: ours

  static constexpr int lifeline_end = 3;
};

/// Starts a program of the PATH by a list of arguments, never through a shell, in its own process
/// group, so that Ctrl-C reaches only us. It ignores no signal. It lacks variables, NAME=VALUE,
/// that begin with a text of `dropped`, and has those of `added`. Errors: Unwritable, with the
/// reason.
Result<pid_t> start_child(std::vector<std::string> words, const ChildStreams& streams,
                          std::span<const std::string_view> dropped = {},
                          std::span<const std::string> added = {});

/// Waits until it has ended.
void await_child(pid_t child);

/// How a program is run to its end.
struct ProgramRun {
  std::span<const std::string_view> dropped = {};  ///< as in `start_child`
  std::span<const std::string> added = {};         ///< likewise
  int input = -1;                                  ///< as in `ChildStreams`
  std::string folder = {};                         ///< likewise
  /// Called with each line of its output, without the line end; of one that is longer than 64 KiB,
  /// only with so much.
  std::function<void(std::string_view)> take_line = {};
  /// The same for its messages, which are kept if it is empty.
  std::function<void(std::string_view)> take_message = {};
  std::chrono::seconds patience = std::chrono::seconds(30);  ///< after which it is killed
  StopRequest should_stop = {};  ///< asked ten times a second; true: it is killed
  bool ends_gently = false;      ///< then it gets a SIGINT first, and some seconds to clean up
};

/// How a program ended.
struct ProgramEnd {
  int code = 0;             ///< its exit code; -1: a signal ended it
  std::string errors = {};  ///< what it wrote to stderr: the first 64 KiB
};

/// Runs a program to its end; what it leaves running in the background is not waited for. Errors:
/// those of `start_child`; Unwritable: it did not end in time, or wrote more than 256 MiB;
/// Interrupted.
Result<ProgramEnd> run_program(const std::vector<std::string>& words, const ProgramRun& run = {});

}  // namespace pliant::cli
