#pragma once

#include <csignal>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/terminal/child.hpp"
#include "cli/terminal/keeper.hpp"
#include "cli/terminal/scratch_folder.hpp"
#include "pliant/core/result.hpp"

namespace pliant::cli {

/// A program that ends with this object, and with the command however that ends, also by SIGKILL;
/// so do all programs that it has started.
///
/// Between the command and the program is its keeper, which waits for the end of either, kills what
/// is left of the program, and holds the folder meanwhile.
class SupervisedProgram {
 public:
  /// Starts a program of the PATH, as `start_child` does. The folder is its working folder, and the
  /// one for its temporary files. Errors: Unwritable, with the reason.
  static Result<SupervisedProgram> start(std::vector<std::string> words,
                                         const ChildStreams& streams, const ScratchFolder& folder);

  SupervisedProgram(SupervisedProgram&&) = default;
  SupervisedProgram& operator=(SupervisedProgram&&) = delete;
  ~SupervisedProgram();

  /// Its exit code, if it has ended; -1: a signal ended it.
  std::optional<int> code();

 private:
  explicit SupervisedProgram(Keeper keeper) : keeper_(std::move(keeper)) {}
  void end_orphans();

  Keeper keeper_;
};

/// The keeper of a program: runs it to its end. `words`: those of the program, and a null; it has
/// the signal mask. Returns the exit code.
int keep_program(const std::string& folder, char** words, const sigset_t& signals);

}  // namespace pliant::cli
