#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/core/triangle_cells.hpp"
#include "pliant/plate/plate.hpp"
#include "pliant/plate/sparse/factored_matrix.hpp"
#include "pliant/plate/time_steps.hpp"
#include "pliant/plate/triangles/cell_block.hpp"

namespace pliant {

/// Everything that stays the same while the steps of an interval run.
struct TriangleProblem {
  Bending bending;
  Dynamics dynamics;
  std::array<Vector3d, 4> slopes = {Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero(),
                                    Vector3d::Zero()};  ///< along -u, +u, -v, +v [1]
  Field load;  ///< #masses x 3: integrated over the plate [length b length^2/uv^4]
};

/// Displacement of all points, and velocity of those with a mass.
struct TriangleState {
  Field displacement;  ///< #points x 3 [length]
  Field velocity;      ///< #masses x 3 [length/s]
};

/// A plate of Morley triangles: M (rho w'' + eta w') + K w = f, where K is the Hessian of the
/// cells' bending energy and M has the masses of the first points on its diagonal. Slopes, and
/// points without a mass, follow at once. docs/model.md, "Surfaces". Not thread-safe.
class TrianglePlate {
 public:
  /// Requires: the first #masses points are free. `choice` is Cholmod or Eigen.
  TrianglePlate(TriangleCells cells, std::vector<double> masses, SolverChoice choice,
                const RunContext& context);

  /// Prepares to solve K + shift M. Reuse: does nothing if both are those of the last call. Errors:
  /// SolverFailed if the matrix is not positive definite; OutOfMemory.
  Result<void> prepare(const Bending& bending, double shift);

  /// Solves for forces on the points with a mass (#masses x 3) on a plate whose held points and
  /// slopes are 0; the displacements there. Requires: `prepare` succeeded. Errors: OutOfMemory.
  Result<Field> solve(const Field& forces);

  /// Advances as `advance_in_steps`. What is held keeps its displacement.
  /// Errors: those of `prepare`; Interrupted.
  Result<TriangleState> advance(const TriangleProblem& problem, const TimeSteps& steps,
                                TriangleState state);

  /// The upper triangle of K + shift M that is factored: without unknowns that belong to one block
  /// of cells.
  SparseMatrix matrix(const Bending& bending, double shift) const;

  const TriangleCells& cells() const { return cells_; }
  const std::vector<double>& masses() const { return masses_; }
  const RunContext& context() const { return context_; }
  SolverCounts counts() const { return matrix_.counts(); }
  std::size_t memory() const { return matrix_.memory(); }

 private:
  Field reduced(const Field& forces) const;
  Field held_forces(const TriangleProblem& problem, const Field& displacement) const;
  using Extended = long double;
  enum class Half { Lower, Both };

  // A sparse matrix by rows, its columns ascending.
  template <class Real>
  struct Rows {
    std::vector<std::size_t> starts = {0};  // #rows + 1
    std::vector<int> columns = {};
    std::vector<Real> values = {};
  };

  template <class Real>
  Rows<Real> rows(const Bending& bending, double shift, Half half) const;
  Field residual(const Field& solution, const Field& right_hand_sides) const;
  double peak(const Field& solution) const;
  void drop_precise();
  bool refines() const { return solve_error_ > 0; }
  Result<Field> solve_refined(const Field& right_hand_sides, std::optional<Field> guess);
  Result<void> measure_error(const SparseMatrix& upper);

  TriangleCells cells_;
  std::vector<double> masses_;
  RunContext context_;
  ReducedUnknowns reduced_;  // those of the matrix
  FactoredMatrix matrix_;
  bool is_factored_ = false;
  Bending bending_;  // of the factored matrix
  double shift_ = 0;

  double solve_error_ = 0;  // of a solution, as a part of its peak; 0: small enough
  Rows<Extended> precise_;  // the factored matrix, if solutions are refined
  MemoryShare precise_share_;
};

}  // namespace pliant
