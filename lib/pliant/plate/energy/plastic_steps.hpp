#pragma once

#include "pliant/plate/plate_solver.hpp"
#include "pliant/plate/step_loop.hpp"

namespace pliant {

/// A plate that flows, on a grid or on triangles, as its steps see it. Fields of displacements x
/// and of forces are on the unknowns (#unknowns x 3), of which the first ones move. With A the
/// matrix of the elastic step and f(x) the forces of what x makes flow, a step solves
/// A x = right-hand side + f(x), eq. (8k). A is only solved. Internal to plate.
class FlowingPlate {
 public:
  virtual ~FlowingPlate() = default;

  /// A^-1 forces.
  virtual Result<Field> solve(const Field& forces) = 0;

  /// The plastic curvatures that x makes of `from`: the return mapping, eq. (8j). Remembers the
  /// places that flow. Returns whether there are any.
  virtual bool flow(const Field& x, const PlasticField& from, PlasticField& to) = 0;

  /// Sum of omega B^T C k_p.
  virtual Field forces_of(const PlasticField& plastic) = 0;

  /// How f changes as x goes along `way`, at the last `flow`.
  virtual Field slope_of(const Field& way) = 0;
};

/// Runs steps `first` to the last of an interval, each of displacement and plastic curvatures
/// together, to 1e-9 of the peak. `terms.known` is without plastic curvatures. Errors: those of
/// `plate`; SolverFailed if a step does not settle; Interrupted.
Result<void> run_plastic_steps(FlowingPlate& plate, const RunContext& context,
                               const StepTerms& terms, double hardening, const TimeSteps& steps,
                               int first, Motion& motion, PlasticField& plastic);

}  // namespace pliant
