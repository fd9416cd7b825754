#pragma once

#include <cstddef>

#include "pliant/core/result.hpp"
#include "pliant/simulation/simulation.hpp"
#include "pliant/sweep/sweep.hpp"

namespace pliant::cli {

/// What the values of a sweep and the lines of its log have, at most. [bytes]
std::size_t memory_of_records(const Sweep& sweep);

/// Estimates the memory of a process that runs takes of a sweep in so many threads: that of the
/// program, of the table of takes, and what all that run at once must have to reserve as much as a
/// take does by itself, or `options.max_memory` if less. Of some takes the one with the largest
/// surfaces is played, for two seconds at most. Takes that cannot be run count for nothing, but for
/// those that lack memory. [bytes] Errors: Interrupted.
Result<std::size_t> memory_of_part(const Sweep& sweep, int threads,
                                   const SimulationOptions& options);

}  // namespace pliant::cli
