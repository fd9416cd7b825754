#pragma once

#include <optional>
#include <string>

#include "cli/commands/scene_input.hpp"
#include "cli/terminal/command_line.hpp"
#include "cli/terminal/resources.hpp"

namespace pliant::cli {

/// Options of `pliant edit`.
struct EditOptions {
  std::optional<std::string> scene = {};  ///< may not be there yet; null: the first screen
  int port = 0;                           ///< 0: any free one
  bool opens_no_browser = false;
  bool is_quiet = false;
  Root root = {};
  ResourceOptions resources;
};

void add_edit(CLI::App& app, EditOptions& options);

/// Serves the page that edits a scene until Ctrl-C. Returns the exit code.
int run_edit(const EditOptions& options);

}  // namespace pliant::cli
