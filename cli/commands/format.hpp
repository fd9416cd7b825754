#pragma once

#include <string>

#include "cli/commands/scene_input.hpp"
#include "cli/terminal/command_line.hpp"

namespace pliant::cli {

/// Options of `pliant format`.
struct FormatOptions {
  std::string scene;
  std::string out;  ///< empty: the standard output
  bool is_in_place = false;
  Root root = {};
};

void add_format(CLI::App& app, FormatOptions& options);

/// Writes a scene in its canonical layout. Returns the exit code.
int run_format(const FormatOptions& options);

}  // namespace pliant::cli
