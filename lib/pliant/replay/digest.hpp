#pragma once

#include "pliant/core/thread_pool.hpp"
#include "pliant/replay/log.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant {

/// The log's frame for the state that `simulation` computes; `threads` hash the surfaces. Errors:
/// those of `Simulation::report`. Internal to replay.
Result<ReplayFrame> digest(Simulation& simulation, int frame, ThreadPool& threads,
                           bool with_states);

}  // namespace pliant
