#pragma once

#include <memory>
#include <string>

#include "pliant/core/thread_pool.hpp"
#include "pliant/plate/linear_solver.hpp"
#include "pliant/plate/plate_solver.hpp"

namespace pliant {

// The implementations behind `make_solver`. Internal to plate.

std::unique_ptr<LinearSolver> make_cholmod_solver(MemoryBudget* budget);
std::unique_ptr<LinearSolver> make_eigen_solver(MemoryBudget* budget);
std::unique_ptr<LinearSolver> make_spectral_solver(MemoryBudget* budget);

// The implementations behind `make_plate_solver`.

std::unique_ptr<PlateSolver> make_spectral_plate_solver(MemoryBudget* budget, ThreadPool* threads,
                                                        int most_lanes);
/// For outlines that `cover_by_rectangles` covers. If a system needs more than `max_rounds`, its
/// matrix is factored.
std::unique_ptr<PlateSolver> make_schwarz_plate_solver(MemoryBudget* budget, ThreadPool* threads,
                                                       int most_lanes = widest_lanes,
                                                       int max_rounds = 60);

/// The error that all implementations report for a matrix they cannot factor.
Error not_positive_definite(long size, long pivot);

/// The error that all implementations report if the factor does not fit in the budget.
Error factor_too_large(long size, const std::string& complaint);

/// The error of a solver that factors no matrix if its working memory does not fit in the budget or
/// in memory.
Error no_memory_to_solve(long size, const std::string& complaint);

/// The error that all implementations report if the factor fits in the budget but not in memory.
Error no_memory_for_factor(long size);

}  // namespace pliant
