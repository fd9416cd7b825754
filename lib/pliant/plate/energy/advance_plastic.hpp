#pragma once

#include "pliant/plate/plate_solver.hpp"

namespace pliant {

/// Advances a plate that yields: each step solves displacement and plastic curvatures together, to
/// 1e-9 of the peak. Steps that yield nowhere have the bits of `solver.advance`. Requires:
/// problem.law. Errors: those of the solver; SolverFailed if a step does not settle.
Result<PlateState> advance_plastic(PlateSolver& solver, const PlateProblem& problem,
                                   const TimeSteps& steps, PlateState state);

}  // namespace pliant
