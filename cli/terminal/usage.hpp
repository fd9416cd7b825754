#pragma once

#include <string>
#include <vector>

#include "cli/terminal/command_line.hpp"

namespace pliant::cli {

/// Arguments of `pliant help`.
struct HelpOptions {
  std::vector<std::string> command = {};  ///< such as `replay record`; empty: all commands
};

void add_help(CLI::App& app, HelpOptions& options);

/// Prints the text of the command's --help. Returns the exit code.
int run_help(const CLI::App& app, const HelpOptions& options);

/// Accepts some words only; a complaint names the nearest one and all of them.
CLI::Validator one_of(std::vector<std::string> words);

/// Prints on stderr why a command line could not be parsed: for a misspelt command or option with
/// the nearest one; if a command is missing, the help. Returns the exit code.
int report_usage(const CLI::App& app, const CLI::ParseError& error);

}  // namespace pliant::cli
