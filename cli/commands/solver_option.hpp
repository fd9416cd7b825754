#pragma once

#include <string>

#include "cli/terminal/command_line.hpp"
#include "pliant/core/result.hpp"
#include "pliant/plate/solver_choice.hpp"

namespace pliant::cli {

void add_solver(CLI::App& command, std::string& solver);

/// The solver of that name. Errors: this build does not have it.
Result<SolverChoice> parse_solver(const std::string& name);

}  // namespace pliant::cli
