#pragma once

#include <functional>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/plate/contact/complementarity.hpp"
#include "pliant/plate/contact/step_contact.hpp"
#include "pliant/plate/plate_solver.hpp"
#include "pliant/plate/step_loop.hpp"

namespace pliant {

/// A plate that meets solids, on a grid or on triangles, as its steps of backward Euler see it: A
/// is the matrix of a step. Forces and solutions are on the unknowns (#unknowns x 3), of which the
/// first ones move. Internal to plate.
struct ContactPlate {
  InverseColumns::Solve solve;  ///< A^-1 forces
  SolvedMatrix matrix;          ///< A, whose solves may be rough
  StepTerms terms;              ///< of its steps
  double dt = 1;                ///< of a step [s]
};

/// The displacement in which a step of backward Euler ends without contact.
Result<Field> free_end(const ContactPlate& plate, const Motion& motion);

/// What the forces of the present rows move, #unknowns x 3, with so much friction; `forces`: these.
/// Errors: those of the plate; SolverFailed if they are not found; Interrupted.
Result<Field> pushed_by_contact(const ContactPlate& plate, Complementarity& problem,
                                const StepContact& contact, const std::vector<double>& bounds,
                                std::vector<Vector3d>& forces);

/// The displacement in which a step ends with the present rows, and their forces.
using Balance =
    std::function<Result<Field>(const std::vector<double>& bounds, std::vector<Vector3d>& forces)>;

/// The displacement in which a step ends that has begun to touch: rows join until none does, and
/// friction has its rounds. Errors: those of `balance`.
Result<Field> settle_contact(StepContact& contact, Complementarity& problem,
                             const Balance& balance);

/// Step `number` of a plate that meets solids, in its interval: of all displacements that keep the
/// rows, the one of least energy. If nothing touches it is `free_end`. Errors: those of the plate;
/// SolverFailed if it does not settle; Interrupted.
Result<void> step_with_contact(const ContactPlate& plate, Complementarity& problem, int number,
                               StepContact& contact, Motion& motion);

/// Tries a step of Newmark's, of which `half` has the steps; whether nothing touches in it, so that
/// it stands. Otherwise nothing has changed.
Result<bool> stands_without_contact(const ContactPlate& half, int number, StepContact& contact,
                                    Motion& motion);

}  // namespace pliant
