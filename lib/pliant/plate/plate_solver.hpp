#pragma once

#include <cstddef>
#include <memory>

#include "pliant/core/memory_budget.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/core/thread_pool.hpp"
#include "pliant/plate/backward_euler.hpp"
#include "pliant/plate/linear_solver.hpp"
#include "pliant/plate/solver_choice.hpp"

namespace pliant {

/// Moves plates in time: the one seam between a body and whoever steps it. It is as wide as an
/// interval, so that an implementation may keep the state in a form of its own for all steps. Every
/// implementation solves the same equations, (8) of docs/model.md, to the last digits, with the
/// same errors; the last digits are its own. Not thread-safe; give each body its own.
class PlateSolver {
 public:
  PlateSolver() = default;
  PlateSolver(const PlateSolver&) = delete;
  PlateSolver& operator=(const PlateSolver&) = delete;
  virtual ~PlateSolver() = default;

  /// Advances a plate as `advance_backward_euler` says. Reuse: what depends on the system alone is
  /// kept while it stays, and never changes a result's bits. Errors: those of `LinearSolver`;
  /// Interrupted.
  virtual Result<PlateState> advance(const PlateProblem& problem, const TimeSteps& steps,
                                     PlateState state, const StopRequest& should_stop = {}) = 0;

  virtual SolverCounts counts() const = 0;

  /// What the solver holds now. [bytes]
  virtual std::size_t memory() const = 0;
};

/// Whether `Auto` solves such a plate in sine space: where it is quicker, unless c is so close to
/// its bound that digits would be lost. Depends on nothing else.
bool worth_transforming(const Grid& grid, const Stiffness& stiffness);

/// Whether `Auto` and `Spectral` solve a plate of another outline by rectangles in sine space, if
/// few of them cover it: where it pays, unless c is so close to its bound that they take long.
/// Depends on nothing else.
bool worth_iterating(int unknowns, const Stiffness& stiffness);

/// A solver that takes its memory out of `budget` and may work on `threads`, which both outlive it;
/// none: no limit, one thread. Its vectors have at most so many doubles, or as few as the
/// architecture allows. The bits depend on none of these. Requires: `choice` is available.
std::unique_ptr<PlateSolver> make_plate_solver(SolverChoice choice = SolverChoice::Auto,
                                               MemoryBudget* budget = nullptr,
                                               ThreadPool* threads = nullptr,
                                               int most_lanes = widest_lanes);

}  // namespace pliant
