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

/// Solves plate systems: the interface between the integrators and the solvers. Every
/// implementation gives the same errors, keeps the same tolerance and passes the same tests. Not
/// thread-safe; give each body its own.
class LinearSolver {
 public:
  LinearSolver() = default;
  LinearSolver(const LinearSolver&) = delete;
  LinearSolver& operator=(const LinearSolver&) = delete;
  virtual ~LinearSolver() = default;

  /// Prepares for `system`. Reuse: does nothing if it equals the last one; the symbolic work is
  /// kept while the outline has the same nodes. Reuse never changes a
  /// result's bits. Errors: SolverFailed, with size and pivot, if the matrix is not positive
  /// definite or not finite; OutOfMemory if the factor does not fit in the budget, which is checked
  /// before it is computed, or in memory.
  virtual Result<void> factor(const PlateSystem& system) = 0;

  /// Solves for three right-hand sides (#unknowns x 3). Requires: `factor` succeeded.
  /// Errors: OutOfMemory.
  virtual Result<Field> solve(const Field& right_hand_sides) = 0;

  virtual SolverCounts counts() const = 0;

  /// The memory that the solver uses now. [bytes]
  virtual std::size_t memory() const = 0;
};

/// The implementations that exist.
enum class SolverKind {
  Cholmod,   ///< SuiteSparse, simplicial LDL^T, AMD order; only with PLIANT_WITH_CHOLMOD
  Eigen,     ///< SimplicialLDLT, AMD order
  Spectral,  ///< sine transforms and small dense factors: `SpectralPlate`; rectangles only
};

/// The implementations in this build, the default one first.
std::vector<SolverKind> available_solvers();

std::string_view name_of(SolverKind kind);

/// A solver of the given kind that reserves its memory from `budget`, which must outlive it; null:
/// no limit. Requires: `kind` is available.
std::unique_ptr<LinearSolver> make_solver(SolverKind kind = available_solvers().front(),
                                          MemoryBudget* budget = nullptr);

}  // namespace pliant
