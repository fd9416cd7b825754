#pragma once

#include "pliant/plate/plate_solver.hpp"

namespace pliant {

/// Advances a plate by backward Euler with any solver: in each step of length dt it solves
///
///   (rho/dt^2 + eta/dt) w' + L w' = F + (rho/dt^2 + eta/dt) w + (rho/dt) v,   v' = (w' - w)/dt (8)
///
/// The rim keeps its displacement, with velocity 0 after the first step. With rho = eta = 0 each
/// step gives the static solution. First order in dt, stable for every dt. The solver's context
/// gives the profile and the stop request, which is called before every step. Requires: state
/// fields are #nodes x 3. Errors: those of the solver; Interrupted.
Result<PlateState> advance_backward_euler(PlateSolver& solver, const PlateProblem& problem,
                                          const TimeSteps& steps, PlateState state);

}  // namespace pliant
