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
#include "pliant/plate/plate.hpp"
#include "pliant/plate/sparse/sparse_plate.hpp"
#include "pliant/plate/time_steps.hpp"
#include "pliant/plate/triangles/cell_block.hpp"
#include "pliant/plate/triangles/inner_unknowns.hpp"
#include "pliant/plate/triangles/plastic_triangles.hpp"

namespace pliant {

struct TriangleContact;

/// One plate of triangles over one interval. The norm of (8h) has `bending` for its form, so that
/// the law's yield has the unit that it has on a grid [length/uv^2].
struct TriangleProblem : PlateInterval {
  Bending bending;
  double goal = 0;  ///< as in `PlateSystem`
};

/// A plate of Morley triangles: M (rho w'' + eta w' + g w) + K w = f, where K is the Hessian of the
/// cells' bending energy and M has the masses of the first points on its diagonal. Slopes, and
/// points without a mass, follow at once. docs/model.md, "Surfaces". Not thread-safe.
class TrianglePlate : private PlateAssembly {
 public:
  /// Whether rounding of a solution is corrected where it matters.
  enum class Accuracy { Rough, Refined };

  /// Requires: the first #masses points are free. `choice` is one of the factors. `factors` null:
  /// the material is even.
  TrianglePlate(TriangleCells cells, std::vector<double> masses, SolverChoice choice,
                const RunContext& context, std::shared_ptr<const CellFactors> factors = {});
  ~TrianglePlate() override;

  /// Prepares to solve K + (goal + shift) M, for vibrations. Reuse: does nothing if all are those
  /// of the last call. Errors: SolverFailed if the matrix is not positive definite; OutOfMemory.
  Result<void> prepare(const Bending& bending, double shift, double goal = 0);

  /// Solves for forces on the points with a mass (#masses x 3) on a plate whose held points and
  /// slopes are 0; the displacements there. Requires: `prepare` succeeded. Errors: OutOfMemory.
  Result<Field> solve(const Field& forces, Accuracy accuracy = Accuracy::Refined);

  /// Advances as `advance_in_steps`, or exactly; with a law as `advance_plastic`, which is not for
  /// exact steps. What is held keeps its displacement. Errors: those of `prepare`; SolverFailed if
  /// a step does not settle; Interrupted.
  Result<PlateState> advance(const TriangleProblem& problem, const TimeSteps& steps,
                             PlateState state);

  /// K + goal M: the upper triangle of what is factored, without unknowns that belong to one block
  /// of cells. Errors: OutOfMemory; Interrupted.
  Result<SparseMatrix> stiffness(const Bending& bending, double goal = 0);

  const TriangleCells& cells() const { return cells_; }

  /// The triangles of the surface that the plate has a part of, ascending: those of the rows of
  /// `PlateState::plastic`, and of the factors of yield and hardening.
  const std::vector<int>& triangles() const { return triangles_; }

  const std::vector<double>& masses() const { return masses_; }
  const CellFactors* factors() const { return factors_.get(); }

  /// The masses times the factors of density. (#masses)
  Eigen::VectorXd weighted_masses() const { return weights().masses; }

  const RunContext& context() const { return context_; }
  SolverChoice solver() const { return solver_; }
  SolverCounts counts() const;
  std::size_t memory() const;

 private:
  class FlowingTriangles;

  // What a plate needs that yields, for one form of bending.
  struct Plasticity {
    Bending bending;
    InnerUnknowns inner;
    PlasticTriangles triangles;
  };

  Result<void> bend(const Bending& bending, double goal);
  Result<Field> reduced(const Field& forces) const;
  Field held_forces(const EdgeTangents& slopes, const Field& displacement) const;
  Result<void> prepare_plasticity();
  Result<SparsePlate*> prepare_contact(const Dynamics& dynamics, const TimeSteps& steps);
  Result<void> advance_with_contact(const TriangleProblem& problem, const TimeSteps& steps,
                                    const Field& forces, Motion& motion);
  Result<void> advance_plastic(const TriangleProblem& problem, const TimeSteps& steps,
                               PlateState& state, Motion& motion);

  int size() const override { return reduced_.count; }
  PlateWeights weights() const override;
  Eigen::VectorXd goals() const override;
  std::size_t most_entries() const override { return reduced_.pairs; }
  Result<Entries<double>> entries() const override { return entries_of<double>(); }
  Result<Entries<long double>> precise_entries() const override {
    return entries_of<long double>();
  }
  template <class Real>
  Result<Entries<Real>> entries_of() const;

  TriangleCells cells_;
  std::vector<double> masses_;
  std::vector<int> triangles_;
  std::shared_ptr<const CellFactors> factors_;
  RunContext context_;
  SolverChoice solver_;
  ReducedUnknowns reduced_;  // those of the matrix
  Bending bending_;          // of the matrix
  double goal_ = 0;          // likewise
  bool is_bent_ = false;     // whether there is a matrix
  SparsePlate plate_;
  std::unique_ptr<TriangleContact> contact_;  // null: it never met anything
  std::optional<Plasticity> plasticity_;
  MemoryShare plastic_share_;
};

}  // namespace pliant
