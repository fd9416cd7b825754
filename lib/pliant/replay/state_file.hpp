#pragma once

#include <string>

#include "pliant/core/result.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant {

/// Writes the state of a simulation at a frame to a file, which appears whole or not at all: to go
/// on from in another process or after an edit of later frames. Errors: as `Simulation::at`;
/// Unwritable.
Result<void> write_state(const std::string& file, Simulation& simulation, int frame);

/// Takes a simulation to the frame whose state the file holds, and gives its number. Errors:
/// Unreadable; as `Simulation::restore`, naming the file.
Result<int> read_state(const std::string& file, Simulation& simulation);

}  // namespace pliant
