#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "cli/terminal/command_line.hpp"
#include "cli/terminal/resources.hpp"
#include "pliant/core/result.hpp"
#include "pliant/sweep/folder.hpp"

namespace pliant::cli {

/// Options of `pliant sweep run --engine slurm`.
struct SlurmOptions {
  std::optional<std::string> engine = {};
  std::optional<std::string> parts = {};
  std::vector<std::string> sbatch = {};  ///< options of sbatch
  bool writes_only = false;              ///< submits nothing
  bool waits = false;
  std::string root = {};  ///< `--root` of the parts; empty: the sweep's own
};

void add_slurm(CLI::App& run, SlurmOptions& options);

/// Checks the options ahead of all work, and that there is an sbatch; `folder` is that of the
/// sweep, as typed. Errors: InvalidInput.
Result<void> check_slurm(const CLI::App& run, const SlurmOptions& options,
                         const std::string& folder);

/// Checks `--parts` against the takes and the size of Slurm's arrays. Errors: InvalidInput; those
/// of `max_array_size`.
Result<void> check_slurm_parts(const SlurmOptions& options, std::size_t takes);

/// Submits the takes of a sweep that are missing, with `retries` those that failed too. Returns the
/// exit code.
int run_on_slurm(const SweepFolder& folder, const SlurmOptions& options,
                 const ResourceOptions& resources, bool retries, bool is_quiet);

}  // namespace pliant::cli
