#pragma once

#include <deque>

#include "pliant/core/result.hpp"
#include "pliant/plate/plate_problem.hpp"
#include "pliant/plate/plate_solver.hpp"

namespace pliant {

/// The slowest vibrations of plates that come again from frame to frame. It never changes a result.
class VibrationCache {
 public:
  /// `smallest_eigenvalue` of a plate, whose shift is 0; `solver` is prepared only if it is not
  /// known. Errors: those of `smallest_eigenvalue`.
  Result<double> smallest(PlateSolver& solver, const PlateSystem& system);

 private:
  struct Known {
    PlateSystem system;
    double lambda = 0;
  };

  std::deque<Known> known_;  // the oldest first
  std::size_t mask_nodes_ = 0;
};

}  // namespace pliant
