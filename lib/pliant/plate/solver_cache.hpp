#pragma once

#include <memory>
#include <span>
#include <vector>

#include "pliant/plate/plate_solver.hpp"

namespace pliant {

/// The solvers of plates that are solved one after another in each frame: one for each outline, so
/// that a plate does not drive out what was kept for another. What is kept never changes a result.
class SolverCache {
 public:
  /// What decides which solver a plate has; two plates of the same outline share one.
  struct Outline {
    int columns = 0;
    int rows = 0;
    InteriorMask interior = {};

    friend bool operator==(const Outline&, const Outline&) = default;
  };

  /// Of solvers as `make_plate_solver` makes them with these arguments.
  explicit SolverCache(SolverChoice choice = SolverChoice::Auto, MemoryBudget* budget = nullptr,
                       ThreadPool* threads = nullptr, int most_lanes = widest_lanes)
      : choice_(choice), budget_(budget), threads_(threads), most_lanes_(most_lanes) {}

  /// Lets go of all solvers but those of `outlines`: ahead of a frame, so that there is room for
  /// those that it needs anew.
  void keep_only(std::span<const Outline> outlines);

  /// The solver of an outline, a new one if need be.
  PlateSolver& solver_of(const Outline& outline);

  /// Of all solvers that ever were, added up.
  SolverCounts counts() const;

 private:
  struct Kept {
    Outline outline;
    std::unique_ptr<PlateSolver> solver;
  };

  SolverChoice choice_;
  MemoryBudget* budget_;
  ThreadPool* threads_;
  int most_lanes_;
  std::vector<Kept> kept_;
  SolverCounts gone_;  // what those did that are no longer kept
};

}  // namespace pliant
