#pragma once

#include <string>
#include <vector>

#include "cli/commands/scene_input.hpp"
#include "cli/terminal/command_line.hpp"

namespace pliant::cli {

/// Options of `pliant import curves` and `pliant export curves`.
struct CurveExchangeOptions {
  std::string file;                   ///< import: of the other program
  std::string scene;                  ///< export
  std::string out;                    ///< import: the scene, "-": its elements on stdout, empty: a
                                      ///< list of the curves; export: the file
  std::vector<std::string> mappings;  ///< import: SOURCE=CHANNEL
  std::vector<std::string> channels;  ///< export: paths; empty: all animated channels
  double offset = 0;                  ///< import [frames]
  std::string up = {};                ///< import: `y` or `z`; empty: y, but vectors are noted
  double tolerance = 1e-4;            ///< as a share of a curve's range
  bool is_strict = false;             ///< a value that would change is an error
  bool is_quiet = false;
  Root root = {};
};

void add_import(CLI::App& app, CurveExchangeOptions& options);
void add_export(CLI::App& app, CurveExchangeOptions& options);

/// Reads keys of other programs into a scene. Returns the exit code.
int run_import(const CurveExchangeOptions& options);

/// Writes keys of a scene for other programs. Returns the exit code.
int run_export(const CurveExchangeOptions& options);

}  // namespace pliant::cli
