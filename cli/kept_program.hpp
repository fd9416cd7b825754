#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <sys/types.h>

#include "child.hpp"
#include "pliant/core/result.hpp"

namespace pliant::cli {

/// A temporary folder, removed by the destructor.
class ScratchFolder {
 public:
  /// In the folder that TMPDIR names, or /tmp. Errors: Unwritable, naming it.
  static Result<ScratchFolder> make();
  ScratchFolder(ScratchFolder&& other) noexcept;
  ScratchFolder& operator=(ScratchFolder&&) = delete;
  ~ScratchFolder();

  const std::string& path() const { return path_; }  ///< absolute

 private:
  explicit ScratchFolder(std::string path) : path_(std::move(path)) {}

  std::string path_;
};

/// A program that ends with this object, and with the command however that ends, also by SIGKILL;
/// so do all programs that it has started.
///
/// Between the command and the program is a keeper: the command again, in a process of its own,
/// which waits for the end of either. It kills what is left of the program, and removes the folder
/// if the program did not end first.
class KeptProgram {
 public:
  /// Starts a program of the PATH, as `start_child` does. The folder is its working folder, and the
  /// one for its temporary files. Errors: Unwritable, with the reason.
  static Result<KeptProgram> start(std::vector<std::string> words, const ChildStreams& streams,
                                   const ScratchFolder& folder);

  KeptProgram(KeptProgram&& other) noexcept;
  KeptProgram& operator=(KeptProgram&&) = delete;
  ~KeptProgram();

  /// Its exit code, if it has ended; -1: a signal ended it.
  std::optional<int> code();

 private:
  KeptProgram(pid_t keeper, int lifeline) : keeper_(keeper), lifeline_(lifeline) {}

  pid_t keeper_;  // 0: it has ended
  int lifeline_;  // a pipe; its closing tells the keeper that this object or the command ended
  int code_ = -1;
};

/// The first argument with which the command starts itself as a keeper.
inline constexpr std::string_view keeper_request = "__keep";

/// A keeper: runs a program to its end. `words`: the folder, the program and its arguments, and a
/// null. Requires: one thread; the descriptor of `ChildStreams::lifeline` is open. Returns the exit
/// code.
int run_keeper(std::span<char*> words);

}  // namespace pliant::cli
