#pragma once

#include "pliant/body/body.hpp"
#include "pliant/core/result.hpp"
#include "pliant/simulation/sampling.hpp"
#include "pliant/simulation/simulation.hpp"
#include "pliant/simulation/step_facts.hpp"

namespace pliant {

/// A surface's way from one frame to the next; kept for its memory. Not for other rooms.
struct Simulation::Stepped {
  bool is_stepped = false;  // in the frame in hand
  bool is_read = false;     // out of the store, rather than solved
  SurfaceInputs inputs;
  Result<StepReport> report;  // of the frame solved last, or why there is none
  StepFacts facts;
};

}  // namespace pliant
