#pragma once

#include <memory>

#include "pliant/plate/linear_solver.hpp"

namespace pliant {

// What each implementation gives to `make_solver`; not for other rooms.

std::unique_ptr<LinearSolver> make_cholmod_solver();
std::unique_ptr<LinearSolver> make_eigen_solver();

/// The error that all implementations report for a matrix they cannot factor.
Error not_positive_definite(long size, long pivot);

/// The error that all implementations report when the factor does not fit in memory.
Error no_memory_for_factor(long size);

}  // namespace pliant
