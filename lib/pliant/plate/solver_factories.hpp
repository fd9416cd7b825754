#pragma once

#include <memory>
#include <string>

#include "pliant/core/thread_pool.hpp"
#include "pliant/plate/linear_solver.hpp"
#include "pliant/plate/plate_solver.hpp"

namespace pliant {

// What each implementation gives to `make_solver`; not for other rooms.

std::unique_ptr<LinearSolver> make_cholmod_solver(MemoryBudget* budget);
std::unique_ptr<LinearSolver> make_eigen_solver(MemoryBudget* budget);
std::unique_ptr<LinearSolver> make_spectral_solver(MemoryBudget* budget);

// And to `make_plate_solver`.

std::unique_ptr<PlateSolver> make_spectral_plate_solver(MemoryBudget* budget, ThreadPool* threads,
                                                        int most_lanes);
/// Of outlines that `cover_by_rectangles` covers. Where a system takes more rounds, its matrix is
/// factored.
std::unique_ptr<PlateSolver> make_schwarz_plate_solver(MemoryBudget* budget, ThreadPool* threads,
                                                       int most_lanes = widest_lanes,
                                                       int max_rounds = 60);

/// The error that all implementations report for a matrix they cannot factor.
Error not_positive_definite(long size, long pivot);

/// The error that all implementations report when the factor is more than the budget has.
Error factor_too_large(long size, const std::string& complaint);

/// The error of a solver that factors no matrix when its working memory is more than the budget
/// has, or than there is.
Error no_memory_to_solve(long size, const std::string& complaint);

/// The error that all implementations report when the factor does not fit in memory all the same.
Error no_memory_for_factor(long size);

}  // namespace pliant
