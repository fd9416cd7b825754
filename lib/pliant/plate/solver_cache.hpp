#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "pliant/plate/outline/outline.hpp"
#include "pliant/plate/plate_solver.hpp"

namespace pliant {

/// The solvers of plates that are solved one after another in each frame: one for each outline, so
/// that a plate does not evict the data kept for another. The cache never changes a result.
class SolverCache {
 public:
  /// For solvers made by `make_plate_solver` with these arguments.
  explicit SolverCache(SolverChoice choice = SolverChoice::Auto, RunContext context = {})
      : choice_(choice), context_(std::move(context)) {}

  /// Destroys all solvers except those of `outlines`. Called before a frame, to make room for the
  /// new solvers it needs.
  void keep_only(std::span<const Outline> outlines);

  /// The solver of an outline; creates it if necessary.
  PlateSolver& solver_of(const Outline& outline);

  /// The sum over all solvers, past and present.
  SolverCounts counts() const;

 private:
  struct Entry {
    Outline outline;
    std::unique_ptr<PlateSolver> solver;
  };

  SolverChoice choice_;
  RunContext context_;
  std::vector<Entry> entries_;
  SolverCounts gone_;  // counts of the solvers that were destroyed
};

}  // namespace pliant
