#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/simulation/frame_store.hpp"

namespace pliant {

/// A store in a folder: a file for each key. Several processes may use one at the same time, and
/// any of them may be killed at any moment: a file appears whole under its name or not at all, and
/// none is ever changed.
///
/// The folder's files are kept within a budget of disk space. Files that no bake has used since
/// this one began are removed first, the longest unused first; then files of this run, about every
/// other frame, so that the remaining ones are spread over the run. Other files of the folder are
/// left alone. Several bakes at once may each exceed the budget by a sixteenth.
class FolderFrameStore final : public FrameStore {
 public:
  /// Creates the folder if it does not exist. Errors: InvalidInput if the name is that of something
  /// else; Unwritable if the folder cannot be created. [bytes]
  static Result<std::unique_ptr<FolderFrameStore>> open(const std::filesystem::path& folder,
                                                        std::size_t byte_budget);

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
  struct Entry {
    std::filesystem::path file;
    std::size_t bytes = 0;  // on the disk
    std::int64_t used = 0;  // [ns] since 1970
    int rank = 0;           // lower ranks are removed first
  };

  FolderFrameStore(std::filesystem::path folder, std::size_t byte_budget);

  std::filesystem::path file_of(const Hash& key) const;
  bool take_room(std::size_t bytes);
  std::vector<Entry> entries() const;
  void make_room(std::size_t bytes);

  std::filesystem::path folder_;
  std::size_t byte_budget_;
  std::int64_t opened_;  // [ns] since 1970

  mutable std::mutex mutex_;       // guards the members below
  bool is_counted_ = false;        // whether `bytes_` is known
  std::size_t bytes_ = 0;          // on the disk at the last count, plus those written since
  std::size_t bytes_written_ = 0;  // since the last count
  std::string trouble_;
  int damaged_count_ = 0;
};

}  // namespace pliant
