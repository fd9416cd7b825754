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

/// Moves plates in time: the interface between a body and its solver. It covers a whole interval,
/// so that an implementation may keep the state in a form of its own for all steps. All
/// implementations solve the same equations, (8) of docs/model.md, and give the same errors; their
/// results may differ in the last digits. Not thread-safe; give each body its own.
class PlateSolver {
 public:
  PlateSolver() = default;
  PlateSolver(const PlateSolver&) = delete;
  PlateSolver& operator=(const PlateSolver&) = delete;
  virtual ~PlateSolver() = default;

  /// Advances a plate as `advance_backward_euler` does. Reuse: values that depend on the system
  /// only are kept until it changes; this never changes a result's bits. Errors: those of
  /// `LinearSolver`; Interrupted.
  virtual Result<PlateState> advance(const PlateProblem& problem, const TimeSteps& steps,
                                     PlateState state, const StopRequest& should_stop = {}) = 0;

  virtual SolverCounts counts() const = 0;

  /// The memory that the solver uses now. [bytes]
  virtual std::size_t memory() const = 0;
};

/// Whether `Auto` solves such a plate in sine space: true if that is faster, unless c is so close
/// to its bound that digits would be lost. Depends on nothing else.
bool worth_transforming(const Grid& grid, const Stiffness& stiffness);

/// Whether `Auto` and `Spectral` solve a plate of another outline by rectangles in sine space, if
/// few of them cover it: true if that is faster, unless c is so close to its bound that many rounds
/// are needed. Depends on nothing else.
bool worth_iterating(int unknowns, const Stiffness& stiffness);

/// A solver that reserves its memory from `budget` and may use `threads`, which must both outlive
/// it; null: no limit, one thread. Its vectors have at most `most_lanes` doubles, or the fewest
/// that the architecture allows. The bits depend on none of these. Requires: `choice` is available.
std::unique_ptr<PlateSolver> make_plate_solver(SolverChoice choice = SolverChoice::Auto,
                                               MemoryBudget* budget = nullptr,
                                               ThreadPool* threads = nullptr,
                                               int most_lanes = widest_lanes);

}  // namespace pliant
