#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "pliant/core/memory_budget.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/plate/number_block.hpp"
#include "pliant/plate/outline/outline.hpp"
#include "pliant/plate/outline/row_blocks.hpp"
#include "pliant/plate/overlap/subdomain.hpp"
#include "pliant/plate/plate_problem.hpp"
#include "pliant/plate/solver_choice.hpp"
#include "pliant/plate/spectral/spectral_plate.hpp"

namespace pliant {

/// A clamped plate whose outline is not a rectangle, solved by conjugate gradients. The
/// preconditioner solves overlapping rectangles in sine space, one after another and back;
/// residuals are computed in extended precision. docs/model.md, "Overlapping rectangles". Memory
/// and work per node and step do not grow with the plate. Internal to plate.
class SchwarzPlate {
 public:
  /// A system may use at most `max_rounds`; most covers need about ten.
  explicit SchwarzPlate(const RunContext& context = {}, int max_rounds = 60)
      : context_(context), memory_(context.memory), max_rounds_(max_rounds) {}

  /// Prepares for a system. Reuse of the last one never changes a result's bits. Requires:
  /// `cover_by_rectangles` finds a cover. Errors: SolverFailed if the matrix is not positive
  /// definite or not finite; OutOfMemory.
  Result<void> prepare(const Outline& outline, const Stiffness& stiffness, double shift);

  /// Solves for three right-hand sides from a guess. Fields are on all nodes, row by row without
  /// gaps, and `first` is node (0,0); only interior nodes are read and written. Requires: prepared.
  /// Errors: SolverFailed if `max_rounds` do not suffice, with `solution` undefined; Interrupted.
  Result<void> solve(const ConstNodesView& load, const NodesView& solution);

  /// One step of backward Euler with the prepared shift; the load excludes the rim's part; views as
  /// above. Requires: prepared; inertia = rho/dt. Errors: those of `solve`; displacement and
  /// velocity are then unchanged.
  Result<void> advance(const ConstNodesView& load, double inertia, double dt,
                       const NodesView& displacement, const NodesView& velocity);

  /// One round over the rectangles and back: an approximation of the solution that is linear in the
  /// right-hand side, symmetric and positive definite. Views as above. Requires: prepared.
  void precondition(const ConstNodesView& load, const NodesView& solution);

  /// Rounds of all systems so far.
  long rounds() const { return rounds_; }

  SolverCounts counts() const { return counts_; }
  std::size_t memory() const;

 private:
  // The plate of a rectangle of the cover, clamped on all sides.
  struct LocalProblem {
    Subdomain subdomain;
    SpectralPlate* plate;
  };
  // A field on all nodes, surrounded by rows of zeros; 0 at nodes that are not interior.
  struct NodeField {
    double* of[3] = {};
  };
  using Sums = double[3];

  Result<void> lay_out();
  void let_go();
  void make_problems(const std::vector<Box>& cover);
  Result<void> iterate();
  bool settle_if_free(int component);
  Result<void> run(bool (&is_unsolved)[3]);
  Result<void> correct();
  bool retire(const Sums& energy, const Sums& change, const Sums& target);
  bool is_any_active() const { return is_active_[0] || is_active_[1] || is_active_[2]; }
  void find_residual();
  void apply_rounds();
  void visit(const LocalProblem& problem, bool is_last);
  void take_correction(const LocalProblem& problem, int component, bool is_last);
  void apply_operator();
  void dot(const NodeField& a, const NodeField& b, Sums& total);
  void add(const NodeField& from, const Sums& factor, const NodeField& to);
  void turn_direction(const Sums& factor);
  template <class Work>
  void for_each(std::size_t count, const Work& work);
  template <class Work>
  void for_each_block(const Work& work);
  template <class Work>
  void for_each_run(const Work& work);

  RunContext context_;
  MemoryShare memory_;
  int max_rounds_;
  long rounds_ = 0;
  int rounds_left_ = 0;  // of the current system
  SolverCounts counts_;

  PlateSystem system_;
  bool is_prepared_ = false;
  double trusted_gain_ = 0;  // how far a residual may fall before it is recomputed
  RowBlocks rows_;
  std::vector<std::unique_ptr<SpectralPlate>> plates_;  // one for each size of rectangle
  std::vector<LocalProblem> problems_;
  std::size_t once_ = 0;  // number of problems, at the end, that a round visits once
  NumberBlock numbers_;
  NodeField load_, solution_, residual_, correction_, direction_;
  NodeField product_;           // operator times direction; during a round, the rest of a residual
  NodeField local_correction_;  // of one rectangle, row after row
  double* block_sums_ = nullptr;
  bool is_active_[3] = {};  // components that are not solved yet
};

}  // namespace pliant
