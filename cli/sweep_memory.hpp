#pragma once

#include <cstddef>

#include "pliant/core/result.hpp"
#include "pliant/simulation/simulation.hpp"
#include "pliant/sweep/sweep.hpp"

namespace pliant::cli {

/// Estimates the memory of a process that runs takes of a sweep in so many threads: that of the
/// program, of the table of takes, and for each thread what a take reserves, or
/// `options.max_memory` if less. Of some takes the one with the largest surfaces is played, for two
/// seconds at most. Takes that cannot be run count for nothing, but
/// for those that lack memory. [bytes] Errors: Interrupted.
Result<std::size_t> memory_of_part(const Sweep& sweep, int threads,
                                   const SimulationOptions& options);

}  // namespace pliant::cli
