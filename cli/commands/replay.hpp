#pragma once

#include <optional>
#include <string>

#include "cli/commands/scene_input.hpp"
#include "cli/terminal/command_line.hpp"
#include "cli/terminal/resources.hpp"

namespace pliant::cli {

/// Options of `pliant replay`.
struct ReplayCommandOptions {
  std::string scene;
  std::string log;
  std::string other_log;
  std::optional<int> last_frame;
  int states_every = 0;
  bool keeps_going = false;
  bool is_quiet = false;
  Root root = {};
  Changes changes = {};
  ResourceOptions resources;
};

void add_replay(CLI::App& app, ReplayCommandOptions& options);

/// Runs the parsed subcommand of `app`: record, verify or diff. Returns the exit code.
int run_replay(const CLI::App& app, const ReplayCommandOptions& options);

}  // namespace pliant::cli
