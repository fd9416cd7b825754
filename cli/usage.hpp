#pragma once

#include <string>
#include <vector>

#include "command_line.hpp"

namespace pliant::cli {

/// What `pliant help` was asked to tell of.
struct HelpOptions {
  std::vector<std::string> command = {};  ///< `replay record`; empty: all
};

void add_help(CLI::App& app, HelpOptions& options);

/// Prints what --help of the command tells. Gives the exit code.
int run_help(const CLI::App& app, const HelpOptions& options);

/// Says on stderr what is wrong with a call that could not be parsed: a misspelt command or option
/// with the nearest one; the help where a command was to follow and none did. Gives the exit code.
int report_usage(const CLI::App& app, const CLI::ParseError& error);

}  // namespace pliant::cli
