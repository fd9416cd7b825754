#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/states/state_store.hpp"

namespace pliant {

/// A store in a folder: a file for each key. Several processes may use one at the same time, and
/// any of them may be killed at any moment: a file appears whole under its name or not at all, and
/// none is ever changed.
///
/// The folder's files are kept within a budget of disk space. Files that no bake has used since
/// this one began are removed first, the longest unused first; then files of this run, about every
/// other frame, so that the remaining ones are spread over the run. Other files of the folder are
/// left alone. Several bakes at once may each exceed the budget by a sixteenth.
class FolderStateStore final : public StateStore {
 public:
  /// Creates the folder if it does not exist. Errors: InvalidInput if the name is that of something
  /// else; Unwritable if the folder cannot be created. [bytes]
  static Result<std::unique_ptr<FolderStateStore>> open(const std::string& folder,
                                                        std::size_t byte_budget);
  ~FolderStateStore() override;

  bool holds(const Hash& key) override;
  std::optional<std::string> read(const Hash& key, std::size_t most) override;

  /// After the first failure nothing more is written: see `trouble`.
  void write(const Hash& key, std::string_view bytes) override;
  void discard(const Hash& key) override;

  /// Why nothing is written any more, in one line; empty: no failure.
  std::string trouble() const;

  /// Number of files that were damaged and have been removed.
  int damaged_count() const;

 private:
  class Folder;
  explicit FolderStateStore(std::unique_ptr<Folder> folder);

  std::unique_ptr<Folder> folder_;
};

}  // namespace pliant
