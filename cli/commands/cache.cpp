#include "cli/commands/cache.hpp"

#include <cstddef>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/terminal/report.hpp"
#include "cli/terminal/resources.hpp"

namespace pliant::cli {
namespace {

void print_note(const CacheOptions& options, const std::string& message) {
  print(stderr, fmt::format("{}: note: {}\n", printable(*options.folder), message));
}

}  // namespace

void add_cache(CLI::App& command, CacheOptions& options) {
  CLI::Option* const folder =
      command.add_option("--cache", options.folder,
                         "Folder that stores each frame's state; a later bake reads "
                         "the states that are still valid instead of solving them");
  command
      .add_option("--cache-size", options.gigabytes,
                  "Most disk space that the folder may use, in GB; the states unused for longest "
                  "are removed first")
      ->check(number_from(0))
      ->capture_default_str()
      ->needs(folder);
}

Result<std::unique_ptr<FolderStateStore>> open_cache(const CacheOptions& options) {
  if (!options.folder) return nullptr;
  if (options.folder->empty())
    return fail(ErrorCode::InvalidInput, "--cache: the name of the folder is empty");
  auto store =
      FolderStateStore::open(*options.folder, static_cast<std::size_t>(options.gigabytes * 1e9));
  if (store) return store;
  if (store.error().code != ErrorCode::Unwritable) {
    return fail(store.error().code,
                fmt::format("--cache {}: {}", printable(*options.folder), store.error().message));
  }
  print_note(options, store.error().message + "; no frame is stored");
  return nullptr;
}

void print_cache_notes(const FolderStateStore* store, const CacheOptions& options) {
  if (!store) return;
  if (const int damaged = store->damaged_count(); damaged > 0) {
    print_note(options, fmt::format("removed {} damaged file{}; those frames were solved again",
                                    damaged, damaged == 1 ? "" : "s"));
  }
  if (const std::string trouble = store->trouble(); !trouble.empty()) {
    print_note(options, trouble + "; not all frames are stored");
  }
}

std::string cache_summary(const FrameCounts& counts) {
  return fmt::format(", {} solved, {} read", counted(counts.solved, "frame"), counts.read);
}

}  // namespace pliant::cli
