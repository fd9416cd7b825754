#pragma once

#include <cstddef>
#include <limits>
#include <string>

#include "cli/terminal/command_line.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant::cli {

/// Limits on the machine's resources for a command.
struct ResourceOptions {
  int threads = 0;        ///< 0: the number of hardware threads
  double max_memory = 0;  ///< [GB of 10^9 bytes]; 0: `default_memory`
};

/// For an option with a number from `least` to 10^9.
CLI::Validator number_from(double least);

/// For an option with an integer from `least` to `most`.
CLI::Validator integer_from(int least, int most = std::numeric_limits<int>::max());

/// Accepts a name that is not empty, as that of a variable which a script did not set is.
CLI::Validator file_name();

void add_threads(CLI::App& command, ResourceOptions& options);
void add_memory(CLI::App& command, ResourceOptions& options);

/// Options of a command's simulation: these resources, and Ctrl-C stops it. Commands request frames
/// in order, so no states are kept for going back. `own` is what the command itself has beside, as
/// far as it grows with its input. [bytes]
SimulationOptions simulation_options(const ResourceOptions& options, std::size_t own = 0);

/// Takes from the memory of a command's simulation what a shelf may keep for it. [bytes]
std::size_t part_for_shelf(SimulationOptions& options);

}  // namespace pliant::cli
