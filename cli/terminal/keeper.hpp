#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <sys/types.h>

#include "cli/terminal/child.hpp"
#include "pliant/core/result.hpp"

namespace pliant::cli {

/// A process that clears up behind the command: the command again, which waits for the end of this
/// object, or of the command however that ends, also by SIGKILL. No signal that can be blocked ends
/// it earlier.
class Keeper {
 public:
  /// `words`: those of `run_keeper`. Errors: Unwritable, with the reason.
  static Result<Keeper> start(std::vector<std::string> words, const ChildStreams& streams);

  Keeper(Keeper&& other) noexcept;
  Keeper& operator=(Keeper&&) = delete;
  ~Keeper() { end(); }

  /// Its exit code, if it has ended; -1: a signal ended it.
  std::optional<int> code();
  /// Waits until it has cleared up.
  void end();

 private:
  Keeper(pid_t process, OpenDescriptor lifeline)
      : process_(process), lifeline_(std::move(lifeline)) {}
  void reap(int options);

  pid_t process_;            // 0: it has ended
  OpenDescriptor lifeline_;  // whose closing tells the keeper that this object or the command ended
  int code_ = 0;
};

/// The first argument with which the command starts itself as a keeper.
inline constexpr std::string_view keeper_request = "__keep";

/// A keeper. `words`: a folder, the program that it keeps and its arguments (see
/// `SupervisedProgram`), or only the place of a folder that it makes (see `ScratchFolder`); and a
/// null. Requires: one thread; the descriptor of `ChildStreams::lifeline` is open. Returns the exit
/// code.
int run_keeper(std::span<char*> words);

/// For a keeper: closes its standard streams, for whoever waits for their end.
void release_streams();

}  // namespace pliant::cli
