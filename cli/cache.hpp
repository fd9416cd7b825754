#pragma once

#include <memory>
#include <optional>
#include <string>

#include "command_line.hpp"
#include "pliant/pliant.hpp"

namespace pliant::cli {

/// Where a bake keeps what it solved, for the next one.
struct CacheOptions {
  std::optional<std::string> folder = {};  ///< none: nowhere
  double gigabytes = 2;                    ///< of the disk, 10^9 bytes each
};

void add_cache(CLI::App& command, CacheOptions& options);

/// The store in the folder that is asked for. None where none is, or with a note on stderr where
/// the folder cannot be made: a bake can do without. Errors: InvalidInput where it is a file.
Result<std::unique_ptr<FolderFrameStore>> open_cache(const CacheOptions& options);

/// Notes on stderr of what became of the store, once the run is over; null: nothing.
void print_cache_notes(const FolderFrameStore* store, const CacheOptions& options);

/// ", 12 frames solved, 83 read" for a summary.
std::string cache_summary(const FrameCounts& counts);

}  // namespace pliant::cli
