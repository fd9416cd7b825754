#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/plate/plate_problem.hpp"
#include "pliant/plate/solver_choice.hpp"
#include "pliant/plate/time_steps.hpp"

namespace pliant {

/// The right-hand side of a step: known + shift w + inertia v, on the unknowns.
struct StepTerms {
  Field known;            ///< #unknowns x 3: by the load, the rim and the tangents
  Eigen::VectorXd shift;  ///< of each unknown [1/uv^4]
  Eigen::VectorXd inertia;
};

/// Neighbouring unknowns.
struct UnknownRun {
  int first = 0, count = 0;
};

/// Solves plates: the interface between all that needs a solution and all that compute one. Every
/// implementation gives the same errors, keeps the same tolerance and passes the same tests;
/// results may differ in the last digits. Not thread-safe; give each body its own.
class PlateSolver {
 public:
  explicit PlateSolver(RunContext context) : context_(std::move(context)) {}
  PlateSolver(const PlateSolver&) = delete;
  PlateSolver& operator=(const PlateSolver&) = delete;
  virtual ~PlateSolver() = default;

  /// Prepares for `system`. Reuse: does nothing if it equals the last one; what depends on the
  /// outline's nodes only is kept while those are the same. Reuse never changes a result's bits.
  /// Errors: SolverFailed, with size and pivot, if the matrix is not positive definite or not
  /// finite; OutOfMemory if the working memory, or a factor, does not fit in the budget, which is
  /// checked before it is computed, or in memory.
  virtual Result<void> prepare(const PlateSystem& system) = 0;

  /// Solves for three right-hand sides (#unknowns x 3). Requires: `prepare` succeeded, and
  /// `advance` was not called since. Errors: OutOfMemory; Interrupted.
  virtual Result<Field> solve(const Field& right_hand_sides) = 0;

  /// Likewise for some of x, y and z; the other right-hand sides are 0. Reuses the solution, which
  /// is as large, and may leave the others of its columns. If there are `runs`, the right-hand
  /// sides are 0 outside, and the solution may be left there. Runs change no bit.
  virtual Result<void> solve_for(const std::vector<int>& components, const Field& right_hand_sides,
                                 std::span<const UnknownRun> runs, Field& solution);

  /// The same as `solve`, but that rounding is never corrected, so that none of the three leaves a
  /// mark on the others.
  virtual Result<Field> solve_roughly(const Field& right_hand_sides) {
    return solve(right_hand_sides);
  }

  /// Advances a plate over an interval as `advance_in_steps` does, which is what happens
  /// unless an implementation overrides it, to keep the state in a form of its own for all steps.
  /// Requires: the implementation overrides it, if the steps are exact.
  /// Its profile receives the times of set-up and solve. The plate is elastic and meets nothing,
  /// except for the solvers of `make_plate_solver`. Reuse and errors: those of `prepare`;
  /// Interrupted.
  virtual Result<PlateState> advance(const PlateProblem& problem, const TimeSteps& steps,
                                     PlateState state);

  /// What steps of `dt` add on the right-hand side, with the rim's displacement. Requires:
  /// `prepare` succeeded for problem.system(dt).
  virtual StepTerms terms(const PlateProblem& problem, double dt, const Field& displacement);

  virtual SolverCounts counts() const = 0;

  /// The memory that the solver uses now. [bytes]
  virtual std::size_t memory() const = 0;

  const RunContext& context() const { return context_; }

 private:
  RunContext context_;
};

/// Whether `Auto` solves such a plate in sine space: true if that is faster, unless c is so close
/// to its bound that digits would be lost. Depends on nothing else.
bool worth_transforming(const Grid& grid, const Stiffness& stiffness);

/// Requires: `choice` is available.
std::unique_ptr<PlateSolver> make_plate_solver(SolverChoice choice = SolverChoice::Auto,
                                               const RunContext& context = {});

}  // namespace pliant
