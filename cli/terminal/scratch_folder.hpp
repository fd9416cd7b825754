#pragma once

#include <string>

#include "cli/terminal/keeper.hpp"
#include "pliant/core/result.hpp"

namespace pliant::cli {

/// A temporary folder, removed by the destructor, and after the command however that ends.
///
/// A keeper makes and removes it, so that there is one for as long as there is the folder. It is
/// locked while a keeper of it, or of a program that works in it, lives: one that is not is left
/// over, and the next keeper in its place removes it.
class ScratchFolder {
 public:
  /// In the folder that TMPDIR names, or /tmp. Errors: Unwritable, naming it.
  static Result<ScratchFolder> make();
  ScratchFolder(ScratchFolder&& other) noexcept;
  ScratchFolder& operator=(ScratchFolder&&) = delete;
  ~ScratchFolder();

  const std::string& path() const { return path_; }  ///< absolute

 private:
  ScratchFolder(std::string path, Keeper keeper)
      : path_(std::move(path)), keeper_(std::move(keeper)) {}

  std::string path_;
  Keeper keeper_;
};

/// Keeps the folder as long as this process lives. False: it is gone.
bool hold_folder(const std::string& folder);

/// The keeper of a new folder in `place`: writes its path to standard output, and removes it after
/// the lifeline's end. Returns the exit code, the number of the error if there can be no folder.
int keep_folder(const std::string& place);

}  // namespace pliant::cli
