#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/core/triangle_cells.hpp"
#include "pliant/plate/exact/sparse_motion.hpp"
#include "pliant/plate/plate.hpp"
#include "pliant/plate/sparse/refined_factor.hpp"
#include "pliant/plate/time_steps.hpp"
#include "pliant/plate/triangles/cell_block.hpp"
#include "pliant/plate/triangles/inner_unknowns.hpp"
#include "pliant/plate/triangles/plastic_triangles.hpp"

namespace pliant {

/// Everything that stays the same while the steps of an interval run.
struct TriangleProblem {
  Bending bending;
  Dynamics dynamics;
  GivenSlopes slopes = {Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
  Field load;  ///< #masses x 3: integrated over the plate [length b length^2/uv^4]

  /// What load and slopes change from, evenly over the interval; only for `Integrator::Exact`.
  Field first_load = {};
  GivenSlopes first_slopes = {Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero(),
                              Vector3d::Zero()};

  /// Of a plate that yields; nullopt: it is elastic. The norm of (8h) has `bending` for its form,
  /// so that `yield` has the unit that it has on a grid [length/uv^2].
  std::optional<PlasticLaw> law = {};
};

/// Displacement of all points, and velocity of those with a mass.
struct TriangleState {
  Field displacement;         ///< #points x 3 [length]
  Field velocity;             ///< #masses x 3 [length/s]
  PlasticField plastic = {};  ///< of a plate that yields: #triangles x 9, those of H [1/length]
};

/// A plate of Morley triangles: M (rho w'' + eta w') + K w = f, where K is the Hessian of the
/// cells' bending energy and M has the masses of the first points on its diagonal. Slopes, and
/// points without a mass, follow at once. docs/model.md, "Surfaces". Not thread-safe.
class TrianglePlate : private PreciseMatrix {
 public:
  /// Requires: the first #masses points are free. `choice` is one of the factors. `factors` null:
  /// the material is even.
  TrianglePlate(TriangleCells cells, std::vector<double> masses, SolverChoice choice,
                const RunContext& context, std::shared_ptr<const CellFactors> factors = {});

  /// Prepares to solve K + shift M; `drag` is the part of the shift that a map of damping changes,
  /// that of density the rest. Reuse: does nothing if all are those of the last call. Errors:
  /// SolverFailed if the matrix is not positive definite; OutOfMemory.
  Result<void> prepare(const Bending& bending, double shift, double drag = 0);

  /// Solves for forces on the points with a mass (#masses x 3) on a plate whose held points and
  /// slopes are 0; the displacements there. Requires: `prepare` succeeded. Errors: OutOfMemory.
  Result<Field> solve(const Field& forces);

  /// Advances as `advance_in_steps`, or exactly; with a law as `advance_plastic`, which is not for
  /// exact steps. What is held keeps its displacement. Errors: those of `prepare`; SolverFailed if
  /// a step does not settle; Interrupted.
  Result<TriangleState> advance(const TriangleProblem& problem, const TimeSteps& steps,
                                TriangleState state);

  /// The upper triangle of K + shift M that is factored: without unknowns that belong to one block
  /// of cells. Errors: Interrupted.
  Result<SparseMatrix> matrix(const Bending& bending, double shift, double drag = 0) const;

  const TriangleCells& cells() const { return cells_; }

  /// The triangles of the surface that the plate has a part of, ascending: those of the rows of
  /// `TriangleState::plastic`, and of the factors of yield and hardening.
  const std::vector<int>& triangles() const { return triangles_; }

  const std::vector<double>& masses() const { return masses_; }
  const CellFactors* factors() const { return factors_.get(); }

  /// The masses times the factors of density. (#masses)
  Eigen::VectorXd weighted_masses() const;

  const RunContext& context() const { return context_; }
  SolverChoice solver() const { return solver_; }
  SolverCounts counts() const { return factor_.counts() + motion_.counts(); }
  std::size_t memory() const {
    return factor_.memory() + motion_.memory() + plastic_share_.bytes();
  }

 private:
  class FlowingTriangles;

  // What a plate needs that yields, for one form of bending.
  struct Plasticity {
    Bending bending;
    InnerUnknowns inner;
    PlasticTriangles triangles;
  };

  class ElasticSteps;

  Result<Field> reduced(const Field& forces) const;
  Field held_forces(const Bending& bending, const GivenSlopes& slopes,
                    const Field& displacement) const;
  Result<void> prepare_plasticity();
  Result<TriangleState> advance_plastic(const TriangleProblem& problem, const TimeSteps& steps,
                                        TriangleState state);
  Result<TriangleState> advance_exactly(const TriangleProblem& problem, const TimeSteps& steps,
                                        TriangleState state);
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
  Result<Rows<Real>> rows(const Bending& bending, double shift, double drag, Half half) const;

  // What the shift adds to the matrix at a point with a mass.
  template <class Real>
  Real shift_at(int point, double shift, double drag) const;

  Result<SparseMatrix> upper() const override { return matrix(bending_, shift_, drag_); }
  Result<void> open(std::size_t entries) override;
  Field residual(const Field& x, const Field& f) const override;
  void close() override;

  TriangleCells cells_;
  std::vector<double> masses_;
  std::vector<int> triangles_;
  std::shared_ptr<const CellFactors> factors_;
  const CellFactors* elastic_;  // the same, if an elastic plate has some
  RunContext context_;
  SolverChoice solver_;
  ReducedUnknowns reduced_;  // those of the matrix
  RefinedFactor factor_;
  bool is_factored_ = false;
  Bending bending_;  // of the factored matrix
  double shift_ = 0, drag_ = 0;

  Rows<Extended> precise_;  // the factored matrix, if solutions are refined
  MemoryShare precise_share_;
  SparseMotion motion_;
  std::optional<Plasticity> plasticity_;
  MemoryShare plastic_share_;
};

}  // namespace pliant
