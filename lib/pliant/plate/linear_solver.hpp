#pragma once

#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/core/result.hpp"
#include "pliant/plate/operator.hpp"
#include "pliant/plate/solver_choice.hpp"

namespace pliant {

/// Solves plate systems: the one seam between the integrators and whoever solves. Every
/// implementation gives the same errors and keeps the same tolerance, and the same tests run over
/// all of them. Not thread-safe; give each body its own.
class LinearSolver {
 public:
  LinearSolver() = default;
  LinearSolver(const LinearSolver&) = delete;
  LinearSolver& operator=(const LinearSolver&) = delete;
  virtual ~LinearSolver() = default;

  /// Makes ready for `system`. Reuse: nothing is done when it equals the last one; the symbolic
  /// work is kept while the numbers of columns and rows and the mask stay. What was kept never
  /// changes a result's bits. Errors: SolverFailed with size and pivot when the matrix is not
  /// positive definite or not finite; OutOfMemory when the factor does not fit in the budget, which
  /// is known before it is computed, or in memory.
  virtual Result<void> factor(const PlateSystem& system) = 0;

  /// Solves for three right-hand sides (#unknowns x 3). Requires: `factor` succeeded.
  /// Errors: OutOfMemory.
  virtual Result<Field> solve(const Field& right_hand_sides) = 0;

  virtual SolverCounts counts() const = 0;

  /// What the solver holds now. [bytes]
  virtual std::size_t memory() const = 0;
};

/// The implementations that exist.
enum class SolverKind {
  Cholmod,   ///< SuiteSparse, simplicial LDL^T, AMD order; only with PLIANT_WITH_CHOLMOD
  Eigen,     ///< SimplicialLDLT, AMD order
  Spectral,  ///< sine transforms and small dense factors: `SpectralPlate`; rectangles only
};

/// Those in this build, the default one first.
std::vector<SolverKind> available_solvers();

std::string_view name_of(SolverKind kind);

/// A solver of the given kind that takes its memory out of `budget`, which outlives it; none: no
/// limit. Requires: `kind` is available.
std::unique_ptr<LinearSolver> make_solver(SolverKind kind = available_solvers().front(),
                                          MemoryBudget* budget = nullptr);

}  // namespace pliant
