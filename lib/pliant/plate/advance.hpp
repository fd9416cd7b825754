#pragma once

#include "pliant/plate/plate_solver.hpp"

namespace pliant {

/// Advances a plate in steps with any solver. A step of backward Euler, of length dt, solves
///
///   (rho/dt^2 + eta/dt) w' + L w' = F + (rho/dt^2 + eta/dt) w + (rho/dt) v,   v' = (w' - w)/dt (8)
///
/// A step of Newmark's is one of dt/2, which gives (w', v'), and goes on to (2 w' - w, 2 v' - v):
/// the trapezoidal rule. Both are stable for every dt. The rim keeps its displacement, with
/// velocity 0. With rho = eta = 0 each step of backward Euler gives the static solution. The
/// solver's context gives the profile and the stop request, which is called before every step.
/// Requires: state fields are #nodes x 3. Errors: those of the solver; Interrupted.
Result<PlateState> advance_in_steps(PlateSolver& solver, const PlateProblem& problem,
                                    const TimeSteps& steps, PlateState state);

struct ContactMemory;

/// What a plate that yields and meets solids needs besides.
struct ContactHelp {
  PlateSolver& whole;  ///< for steps in which something touches, as of `advance_with_contact`
  ContactMemory& memory;
};

/// Advances a plate that yields: each step solves displacement and plastic curvatures together, to
/// 1e-9 of the peak. Steps that yield nowhere have the bits of `solver.advance`; those up to the
/// first in which something touches are as without contact. Requires: problem.law; `help` if there
/// is problem.contact. Errors: those of the solver; SolverFailed if a step does not settle.
Result<PlateState> advance_plastic(PlateSolver& solver, const PlateProblem& problem,
                                   const TimeSteps& steps, PlateState state,
                                   const ContactHelp* help = nullptr);

}  // namespace pliant
