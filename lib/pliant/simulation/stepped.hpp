#pragma once

#include "pliant/body/body.hpp"
#include "pliant/core/result.hpp"
#include "pliant/simulation/sampling.hpp"
#include "pliant/simulation/simulation.hpp"
#include "pliant/simulation/step_facts.hpp"

namespace pliant {

/// A surface's step from one frame to the next; reused to avoid allocations. Not for other rooms.
struct Simulation::Stepped {
  bool is_stepped = false;  // in the present frame
  bool is_read = false;     // read from the store, not solved
  SurfaceInputs inputs;
  Result<StepReport> report;  // of the last solved frame, or its error
  StepFacts facts;
};

}  // namespace pliant
