#pragma once

#include <string_view>
#include <vector>

#include "cli/terminal/command_line.hpp"

namespace pliant::cli {

/// The first argument with which a shell's completion script requests completions.
inline constexpr std::string_view completion_request = "__complete";

/// Prints completions for the last of these words. `words` are those after `pliant` on the line so
/// far.
///
/// The first line gives the kind: `words`, followed by one word per line, with its description
/// after a tab; `files` with the wanted extensions, or without any for all files; `folders`. The
/// scripts in cli/terminal/completion translate this for each shell. It is derived from the
/// declared options, so there is no separate list to maintain. Returns the exit code.
int run_complete(const CLI::App& app, const std::vector<std::string_view>& words);

}  // namespace pliant::cli
