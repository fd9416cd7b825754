#pragma once

#include <string_view>
#include <vector>

#include "command_line.hpp"

namespace pliant::cli {

/// The first argument by which a shell's completion asks what may stand at the end of a line.
inline constexpr std::string_view completion_request = "__complete";

/// Prints what the last of these words, those behind `pliant` on the line so far, may go on to be.
///
/// The first line says what kind of thing: `words`, with one a line behind it, and what it does
/// after a tab; `files` with the endings that are asked for, or without any for all; `folders`.
/// The scripts in cli/completion make of it what each shell wants. All of it comes from the options
/// as they are declared, so that no list has to be kept beside them. Gives the exit code.
int run_complete(const CLI::App& app, const std::vector<std::string_view>& words);

}  // namespace pliant::cli
