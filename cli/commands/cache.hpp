#pragma once

#include <memory>
#include <optional>
#include <string>

#include "cli/terminal/command_line.hpp"
#include "pliant/pliant.hpp"

namespace pliant::cli {

/// The cache of a bake.
struct CacheOptions {
  std::optional<std::string> folder = {};  ///< null: no cache
  double gigabytes = 2;                    ///< most disk space, 10^9 bytes each
};

void add_cache(CLI::App& command, CacheOptions& options);

/// The store in the requested folder. Null if no folder was requested, or, with a note on stderr,
/// if the folder cannot be made: a bake works without it. Errors: InvalidInput if it is a file.
Result<std::unique_ptr<FolderStateStore>> open_cache(const CacheOptions& options);

/// Prints notes on stderr about the store after a run; null: prints nothing.
void print_cache_notes(const FolderStateStore* store, const CacheOptions& options);

/// ", 12 frames solved, 83 read" for a summary.
std::string cache_summary(const FrameCounts& counts);

}  // namespace pliant::cli
