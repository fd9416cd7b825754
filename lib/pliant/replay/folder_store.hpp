#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/simulation/frame_store.hpp"

namespace pliant {

/// A store in a folder: a file for each key. Several processes may use one at the same time, and
/// any of them may be killed at any moment: a file appears whole under its name or not at all, and
/// none is ever changed.
///
/// The folder's files are kept within a budget of disk space. What no bake has used since this one
/// began goes first, the longest unused ahead; then this run's own, every other frame or so, so
/// that what stays is spread over the run. Other files of the folder are left alone. Several bakes
/// at once may pass the budget by a sixteenth each.
class FolderFrameStore final : public FrameStore {
 public:
  /// Makes the folder where it is not there. Errors: InvalidInput where something else has the
  /// name; Unwritable where it cannot be made. [bytes]
  static Result<std::unique_ptr<FolderFrameStore>> open(const std::string& folder,
                                                        std::size_t byte_budget);
  ~FolderFrameStore() override;

  bool holds(const Hash& key) override;
  std::optional<std::string> read(const Hash& key, std::size_t most) override;

  /// The first one that fails is the last: see `trouble`.
  void write(const Hash& key, std::string_view bytes) override;
  void discard(const Hash& key) override;

  /// Why nothing is written any more; empty: it is. One line.
  std::string trouble() const;

  /// Files that were not what had been written, and are gone now.
  int damaged_count() const;

 private:
  class Folder;
  explicit FolderFrameStore(std::unique_ptr<Folder> folder);

  std::unique_ptr<Folder> folder_;
};

}  // namespace pliant
