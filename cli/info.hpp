#pragma once

#include <string>

#include "command_line.hpp"
#include "resources.hpp"
#include "scene_input.hpp"

namespace pliant::cli {

/// What `pliant info` was asked to do.
struct InfoOptions {
  std::string scene;
  Root root = {};
  bool is_json = false;
  ResourceOptions resources;
};

void add_info(CLI::App& app, InfoOptions& options);

/// Prints what is in a scene, and what each force would do. Gives the exit code.
int run_info(const InfoOptions& options);

}  // namespace pliant::cli
