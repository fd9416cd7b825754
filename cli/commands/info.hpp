#pragma once

#include <string>

#include "cli/commands/scene_input.hpp"
#include "cli/terminal/command_line.hpp"
#include "cli/terminal/resources.hpp"

namespace pliant::cli {

/// Options of `pliant info`.
struct InfoOptions {
  std::string scene;  ///< or a mesh file
  Root root = {};
  Changes changes = {};
  bool is_json = false;
  bool is_quiet = false;
  ResourceOptions resources;
};

void add_info(CLI::App& app, InfoOptions& options);

/// Prints the content of a scene and a preview of each force; of a mesh file its objects. Returns
/// the exit code.
int run_info(const InfoOptions& options);

}  // namespace pliant::cli
