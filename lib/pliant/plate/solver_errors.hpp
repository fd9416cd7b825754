#pragma once

#include <string>

#include "pliant/core/result.hpp"

namespace pliant {

// The errors of solvers, the same for all. Internal to plate.

/// The matrix cannot be factored.
Error not_positive_definite(long size, long pivot);

/// The factor does not fit in the budget.
Error factor_too_large(long size, const std::string& complaint);

/// The working memory of a solver that factors no matrix does not fit in the budget or in memory.
Error no_memory_to_solve(long size, const std::string& complaint);

/// The factor fits in the budget, but not in memory.
Error no_memory_for_factor(long size);

}  // namespace pliant
