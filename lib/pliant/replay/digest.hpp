#pragma once

#include "pliant/core/thread_pool.hpp"
#include "pliant/replay/log.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant {

/// The frame that a log has for what `simulation` computes, the surfaces being hashed on `threads`.
/// Errors: those of `Simulation::report`. Not for other rooms.
Result<ReplayFrame> digest(Simulation& simulation, int frame, ThreadPool& threads,
                           bool with_states);

}  // namespace pliant
