#pragma once

#include <string>
#include <vector>

#include "cli/commands/scene_input.hpp"
#include "cli/terminal/command_line.hpp"
#include "cli/terminal/resources.hpp"

namespace pliant::cli {

/// Options of `pliant validate`.
struct ValidateOptions {
  std::vector<std::string> scenes;
  bool is_quiet = false;
  Root root = {};
  bool is_json = false;
  ResourceOptions resources;
};

void add_validate(CLI::App& app, ValidateOptions& options);

/// Reads and checks scenes without running them. Returns the exit code.
int run_validate(const ValidateOptions& options);

}  // namespace pliant::cli
