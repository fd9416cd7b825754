#pragma once

#include <cstddef>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/plate/exact/sparse_motion.hpp"
#include "pliant/plate/plate_solver.hpp"
#include "pliant/plate/sparse/refined_factor.hpp"
#include "pliant/plate/step_loop.hpp"

namespace pliant {

/// A plate on its unknowns, of a grid or of triangles: rho M w'' + eta G w' + K w = f, with the
/// matrix K, goal included, and the diagonals M and G of an assembly. Unknowns without a mass, the
/// last ones, follow at once. Fields of forces and solutions are #unknowns x 3. Internal to plate.
class SparsePlate {
 public:
  /// `choice` is one of the factors.
  SparsePlate(SolverChoice choice, const RunContext& context)
      : context_(context), matrix_(context), factor_(matrix_, choice, context), motion_(context) {}

  /// Becomes the plate of an assembly, which outlives it here. Errors: OutOfMemory; Interrupted.
  Result<void> assemble(const PlateAssembly& assembly);

  /// Factors K + (shift - drag) M + drag G: those of a step, `PlateSystem`. Reuse: does nothing if
  /// that is factored. Requires: `assemble` succeeded. Errors: SolverFailed if it is not positive
  /// definite; OutOfMemory; Interrupted.
  Result<void> prepare(double shift, double drag);

  /// The same for steps of these dynamics, exact ones too.
  Result<void> prepare(const Dynamics& dynamics, const TimeSteps& steps);

  /// Solves with what is prepared. Errors: OutOfMemory; Interrupted.
  Result<Field> solve(const Field& forces) { return factor_.solve(forces); }

  /// The same; rounding is not corrected.
  Result<Field> solve_roughly(const Field& forces) { return factor_.solve_roughly(forces); }

  /// Advances the unknowns that move, under forces that change evenly if the steps are exact, and
  /// otherwise stay as they are last; how many steps were gone. Exact ones ask nobody. Requires:
  /// `prepare` for these dynamics and steps. Errors: those of the solves; Interrupted.
  Result<int> advance(const Dynamics& dynamics, const TimeSteps& steps, const ForceChange& forces,
                      Motion& motion, const StepFilter& accepts = {});

  /// What a step of `dt` adds on the right-hand side.
  StepTerms terms(Field known, const Dynamics& dynamics, double dt) const;

  const PlateWeights& weights() const { return weights_; }
  const SparseMatrix& stiffness() const { return matrix_.stiffness(); }  ///< K, its upper triangle

  SolverCounts counts() const { return factor_.counts() + motion_.counts(); }
  std::size_t memory() const { return matrix_.memory() + factor_.memory() + motion_.memory(); }

 private:
  RunContext context_;
  PlateMatrix matrix_;
  PlateWeights weights_;
  RefinedFactor factor_;
  bool is_factored_ = false;
  bool has_factored_pattern_ = false;  // whether K has the pattern that was factored last
  double shift_ = 0, drag_ = 0;        // of the factor
  SparseMotion motion_;
};

}  // namespace pliant
