#pragma once

#include <string>

#include "pliant/core/result.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant {

/// Writes the state of a simulation at a frame to a file, which appears whole or not at all: a
/// checkpoint for another process, or for use after an edit of later frames. Errors: as
/// `Simulation::at`; Unwritable.
Result<void> write_state(const std::string& file, Simulation& simulation, int frame);

/// Restores the state in the file, and returns its frame number. Errors: Unreadable; as
/// `Simulation::restore`, naming the file.
Result<int> read_state(const std::string& file, Simulation& simulation);

}  // namespace pliant
