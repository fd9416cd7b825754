#include "pliant/plate/solver_errors.hpp"

#include <fmt/format.h>

namespace pliant {

Error not_positive_definite(long size, long pivot) {
  return {ErrorCode::SolverFailed,
          fmt::format("the plate's matrix of {} unknowns is not positive definite: it failed at "
                      "pivot {}",
                      size, pivot)};
}

Error factor_too_large(long size, const std::string& complaint) {
  return {ErrorCode::OutOfMemory,
          fmt::format("the factor of the plate's matrix of {} unknowns {}", size, complaint)};
}

Error no_memory_to_solve(long size, const std::string& complaint) {
  return {ErrorCode::OutOfMemory,
          fmt::format("the solve of the plate of {} unknowns {}", size, complaint)};
}

Error no_memory_for_factor(long size) {
  return {
      ErrorCode::OutOfMemory,
      fmt::format("the factor of the plate's matrix of {} unknowns does not fit in memory", size)};
}

}  // namespace pliant
