#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/scene/scene_texts.hpp"
#include "pliant/sweep/input_hashes.hpp"
#include "pliant/sweep/request.hpp"
#include "pliant/sweep/takes.hpp"

namespace pliant {

// The file sweep.json: what was asked, and everything that takes are made from. Internal to sweep.

struct SweepFile {
  std::string version = {};  ///< of pliant
  std::string engine = {};   ///< its digest
  SweepRequest request = {};
  std::string table_hash = {};  ///< of the table in the request, which itself is not stored
  std::vector<SceneTexts> texts = {};
  std::vector<InputHash> inputs = {};
  TakePlan takes = {};  ///< of a file that was read
};

/// Writes it with these takes, whole or not at all, and never in place of another. Whether it is
/// written now; if not, there is one. Errors: InvalidInput: a name is no UTF-8; it is larger than
/// `largest_sweep_file`; Unwritable; Interrupted.
Result<bool> write_sweep_file(const SweepFile& content, const TakePlan& takes,
                              const std::filesystem::path& file,
                              const StopRequest& should_stop = {});

/// Errors: Unreadable, also if it is too large; InvalidInput: it is no such file; Interrupted.
Result<SweepFile> read_sweep_file(const std::filesystem::path& file,
                                  const StopRequest& should_stop = {});

/// A million takes with the most intervals have some 0.7 GB. [bytes]
inline constexpr std::size_t largest_sweep_file = std::size_t{2} << 30U;

/// What differs between a sweep and what is asked now, in words that can follow `it has `; empty:
/// nothing does. The hashes of files do not count.
std::string difference_of(const SweepFile& there, const SweepFile& asked);

}  // namespace pliant
