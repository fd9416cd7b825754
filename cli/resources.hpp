#pragma once

#include <string>

#include "command_line.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant::cli {

/// What a command may use of the machine.
struct ResourceOptions {
  int threads = 0;        ///< 0: as many as the machine runs at once
  double max_memory = 0;  ///< [GB of 10^9 bytes]; 0: three quarters of what the machine has
};

/// Of an option that takes a number from `least` to 10^9.
CLI::Validator number_from(double least);

void add_threads(CLI::App& command, ResourceOptions& options);
void add_memory(CLI::App& command, ResourceOptions& options);

/// How a simulation of this command runs: these resources, and Ctrl-C stops it. Frames are asked
/// for in order, so that nothing is kept for going back.
SimulationOptions simulation_options(const ResourceOptions& options);

}  // namespace pliant::cli
