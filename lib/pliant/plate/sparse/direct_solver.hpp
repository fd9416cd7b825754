#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <optional>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/plate/plate_solver.hpp"
#include "pliant/plate/solver_errors.hpp"
#include "pliant/plate/sparse/operator.hpp"

namespace pliant {

/// A solver that factors the sparse matrix. The template contains the logic that such solvers
/// share: which results are kept, and when. `Factorization` has `Result<void> analyze(const
/// SparseMatrix&)`, `std::size_t factor_entries() const` for the analysed matrix, `Result<void>
/// factorize(const SparseMatrix&)` for a matrix of the same pattern, and `Result<Field> solve(const
/// Field&)`; the matrices are upper triangles.
template <class Factorization>
class DirectSolver final : public PlateSolver {
 public:
  explicit DirectSolver(const RunContext& context)
      : PlateSolver(context), memory_(context.memory) {}

  Result<void> prepare(const PlateSystem& system) override try {
    if (factored_ == system) return {};
    const bool same_pattern = factored_ && have_same_nodes(factored_->outline, system.outline);
    factored_.reset();
    const long size = unknown_count(system.outline);
    if (!same_pattern) {
      // Free the old factor first, to make room for the new one.
      factorization_ = std::make_unique<Factorization>();
      if (auto taken = take(size, bytes_to_analyze * size); !taken) return taken;
    }
    const SparseMatrix matrix = assemble_upper(system);
    if (!same_pattern) {
      ++counts_.analyses;
      if (auto analyzed = factorization_->analyze(matrix); !analyzed) return analyzed;
      const std::size_t factor = bytes_of_entry * factorization_->factor_entries();
      if (auto taken = take(size, bytes_to_factorize * size + factor); !taken) return taken;
    }
    ++counts_.factorizations;
    if (auto factorized = factorization_->factorize(matrix); !factorized) return factorized;
    factored_ = system;
    refinement_passes_ = passes_for(estimate_condition(system));
    return {};
  } catch (const std::bad_alloc&) {  // the only way in which Eigen reports it
    return fail(no_memory_for_factor(unknown_count(system.outline)));
  }

  Result<Field> solve(const Field& right_hand_sides) override try {
    PLIANT_EXPECTS(factored_ && right_hand_sides.rows() == unknown_count(factored_->outline));
    ++counts_.solves;
    auto solution = factorization_->solve(right_hand_sides);
    for (int pass = 0; solution && pass < refinement_passes_; ++pass) {
      auto correction = factorization_->solve(residual(*factored_, *solution, right_hand_sides));
      if (!correction) return correction;
      *solution += *correction;
    }
    return solution;
  } catch (const std::bad_alloc&) {
    return fail(no_memory_for_factor(right_hand_sides.rows()));
  }

  SolverCounts counts() const override { return counts_; }

  std::size_t memory() const override { return memory_.bytes(); }

 private:
  // Per unknown, for the analysis: the matrix's upper triangle (7 entries of 12 bytes) and the full
  // pattern that the ordering copies, with elbow room and a dozen integers. For the factorisation,
  // beside the factor: the matrix, its permuted copy, and right-hand sides, solution and workspace
  // of three columns each.
  static constexpr std::size_t bytes_to_analyze = 250;
  static constexpr std::size_t bytes_to_factorize = 350;
  static constexpr std::size_t bytes_of_entry = 12;  // of the factor: a double and an index

  Result<void> take(long size, std::size_t bytes) {
    if (memory_.try_resize(bytes)) return {};
    factorization_.reset();
    return fail(factor_too_large(size, memory_.complaint(bytes)));
  }

  // Iterative refinement. A factorisation leaves a relative error of up to condition x eps, and
  // each pass with an exact residual multiplies the error by that factor again. Without it a static
  // plate of 401 x 401 is off by 1e-8. One pass if the error may exceed 2e-9, two if it may exceed
  // 1e-5.
  static int passes_for(double condition) {
    if (!(condition < 1e11)) return 2;
    return condition > 1e7 ? 1 : 0;
  }

  MemoryShare memory_;
  std::unique_ptr<Factorization> factorization_;
  std::optional<PlateSystem> factored_;  // the system of `factorization_`; nullopt after a failure
  int refinement_passes_ = 0;            // needed for `factored_`
  SolverCounts counts_;
};

}  // namespace pliant
