#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/commands/bake.hpp"
#include "cli/commands/scene_input.hpp"
#include "cli/sweep/sweep_slurm.hpp"
#include "cli/terminal/command_line.hpp"
#include "cli/terminal/resources.hpp"
#include "pliant/sweep/folder.hpp"

namespace pliant::cli {

/// Options of `pliant sweep run`.
struct SweepRunOptions {
  std::vector<std::string> what;  ///< scenes, or the folder of a sweep
  std::optional<std::string> out = {};
  Changes set = {};
  std::vector<std::string> vary = {};
  std::optional<std::string> sample = {};
  std::optional<std::string> takes = {};  ///< a CSV file
  std::optional<std::string> frames = {};
  std::string solver = "auto";
  Root root = {};
  std::optional<std::string> write = {};
  std::optional<std::string> part = {};
  bool makes_only = false;
  bool is_dry = false;
  bool retries = false;
  bool is_quiet = false;
  SlurmOptions slurm = {};
  ResourceOptions resources;
};

/// Options of `pliant sweep status`.
struct SweepStatusOptions {
  std::string folder;
  Root root = {};
};

/// Options of `pliant sweep verify`.
struct SweepVerifyOptions {
  std::string folder;
  int every = 1;
  Root root = {};
  bool is_quiet = false;
  ResourceOptions resources;
};

/// Options of `pliant sweep bake`.
struct SweepBakeOptions {
  std::string folder;
  std::string take;
  BakeOptions bake;
};

/// Options of `pliant sweep view`.
struct SweepViewOptions {
  std::string folder;
  std::optional<std::string> out = {};  ///< the page
  std::optional<std::string> png = {};  ///< a picture of the contact sheet
  std::optional<int> frame = {};        ///< of all pictures; null: that of each take's peak
  Root root = {};
  std::string size = "320x240";  ///< of each take in the picture [px]
  std::string look;              ///< of the picture, in the syntax of the page's address
  bool is_quiet = false;
  ResourceOptions resources;
};

/// Options of `pliant sweep`.
struct SweepOptions {
  SweepRunOptions run;
  SweepStatusOptions status;
  SweepVerifyOptions verify;
  SweepBakeOptions bake;
  SweepViewOptions view;
};

void add_sweep(CLI::App& app, SweepOptions& options);
void add_sweep_run(CLI::App& sweep, SweepRunOptions& options);
void add_sweep_verify(CLI::App& sweep, SweepVerifyOptions& options);
void add_sweep_bake(CLI::App& sweep, SweepBakeOptions& options);
void add_sweep_view(CLI::App& sweep, SweepViewOptions& options);

// Each returns the exit code.

int run_sweep(const CLI::App& app, const SweepOptions& options);
int run_sweep_run(const CLI::App& run, const SweepRunOptions& options);
int run_sweep_status(const SweepStatusOptions& options);
int run_sweep_verify(const SweepVerifyOptions& options);
int run_sweep_bake(const SweepBakeOptions& options);
int run_sweep_view(const SweepViewOptions& options);

/// `SweepFolder::open`. Errors: also those of `folder_of`.
Result<SweepFolder> open_sweep(const std::string& folder, const Root& root);

/// Counts the takes of a sweep, or of a part, on stdout unless it is quiet, and names failures on
/// stderr; writes the table unless it is a part, K/P as typed. Returns the exit code: 0 if all
/// these takes are done.
int tell_status(const SweepFolder& folder, bool is_quiet = false, const SweepPart& part = {},
                const std::optional<std::string>& part_text = {});

/// Whether a file is no part of a sweep, so that a command may write it. Errors: InvalidInput,
/// naming the option.
Result<void> check_no_part(std::string_view option, const std::string& file,
                           const SweepFolder& folder);

/// Prints takes of which the log has two hashes on stderr, those of a part.
void print_conflicts(const SweepStatus& status, const SweepPart& part = {});

/// Prints conflicts of the log and the takes that failed on stderr, those of a part: ten of them,
/// then their number.
void print_failures(const SweepFolder& folder, const SweepStatus& status,
                    const SweepPart& part = {});

}  // namespace pliant::cli
