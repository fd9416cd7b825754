#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/plate/exact/substeps.hpp"
#include "pliant/plate/solver_choice.hpp"
#include "pliant/plate/sparse/supernodal_numbers.hpp"
#include "pliant/plate/time_steps.hpp"

namespace pliant {

/// M (rho w'' + eta w') + K w = f with sparse K and diagonal M; not all unknowns need a mass.
struct MovingMatrix {
  SparseMatrix stiffness;       ///< the upper triangle of K, by columns; positive semidefinite
  std::vector<double> inertia;  ///< M rho of the first unknowns; the others have no mass
  std::vector<double> drag;     ///< M eta of the same ones; not both are 0
};

/// Forces on the unknowns (#unknowns x 3) at both ends of an interval; linear in between.
struct ForceChange {
  Field first, last;
};

/// Solves the equation of a `MovingMatrix` over an interval, to 1e-6 of its motion in each of 250
/// intervals, in steps of `SubStep`. Orders and factors of equal matrices are taken from the shelf,
/// if they are there; what is reserved is the same. Internal to plate.
class SparseMotion {
 public:
  explicit SparseMotion(const RunContext& context)
      : context_(context), alone_(context), memory_(context.memory) {
    alone_.threads = nullptr;
  }

  /// Prepares for a matrix. Reuse: keeps factors if it equals the last one, else the order if its
  /// pattern does; this never changes a bit. Errors: OutOfMemory.
  Result<void> prepare(MovingMatrix matrix);

  /// Advances w and v of the unknowns with a mass (#masses x 3) by `steps`, which are exact.
  /// Requires: `prepare` succeeded last. Errors: SolverFailed; OutOfMemory; Interrupted.
  Result<void> advance(const TimeSteps& steps, const ForceChange& forces, Field& w, Field& v);

  SolverCounts counts() const { return counts_; }  ///< a complex solve counts as two
  std::size_t memory() const { return memory_.bytes(); }

 private:
  using ComplexFactor = SupernodalNumbers<Complex>;
  // One for each pole, or the one that holds.
  using ComplexFactors = std::vector<ComplexFactor>;

  // The factors for steps of one length.
  struct Factors {
    double length = 0;
    std::shared_ptr<const ComplexFactors> of_pole;
  };
  struct PatternItem;
  struct FactorsItem;
  // Workspace of one pole: its solution in the order of the factor.
  using Solutions = std::array<NumberBlock, pole_count>;

  Result<void> find_pattern(const SparseMatrix& matrix);
  Result<std::shared_ptr<const ComplexFactors>> find_factors(
      double length, std::size_t count, const std::function<Result<void>(ComplexFactors&)>& make);
  Result<Factors*> factors_for(double length);
  Result<void> find_massless(const Field& force, Field& w);
  double* cleared(std::size_t pole);
  Field product(const Field& w) const;
  Result<void> solve(const Factors& factors, const SubStep& step, const Field& lack,
                     const Field& growth, const Field& v);
  template <class Work>
  void for_each_pole(const Work& work);

  RunContext context_;
  RunContext alone_;  // of one pole
  MemoryShare memory_;
  std::shared_ptr<const MovingMatrix> matrix_;  // null: none
  std::shared_ptr<const SupernodePattern> pattern_ = std::make_shared<const SupernodePattern>();
  std::list<Factors> factors_;                     // the last used first
  std::shared_ptr<const ComplexFactors> holding_;  // finds unknowns without a mass; null: not yet
  Solutions solutions_;
  SolverCounts counts_;
};

}  // namespace pliant
