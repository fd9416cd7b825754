#pragma once

#include <string>
#include <vector>

#include "cli/commands/scene_input.hpp"
#include "cli/terminal/command_line.hpp"

namespace pliant::cli {

/// Options of `pliant curves`.
struct CurvesOptions {
  std::string scene;
  std::vector<std::string> channels;  ///< paths; empty: all animated channels
  std::string frames;                 ///< A:B or one frame; empty: the scene's range
  double step = 1;                    ///< [frames]
  std::string at;                     ///< file with one frame per line; empty: none
  std::string out;                    ///< .csv or .svg; empty: CSV on stdout
  bool has_sides = false;
  Root root = {};
  Changes changes = {};
};

void add_curves(CLI::App& app, CurvesOptions& options);

/// Samples channels of a scene, as a table or a plot. Returns the exit code.
int run_curves(const CurvesOptions& options);

}  // namespace pliant::cli
