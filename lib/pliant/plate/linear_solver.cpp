#include "pliant/plate/linear_solver.hpp"

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/plate/solver_factories.hpp"

namespace pliant {

std::vector<SolverKind> available_solvers() {
#ifdef PLIANT_WITH_CHOLMOD
  return {SolverKind::Cholmod, SolverKind::Eigen, SolverKind::Spectral};
#else
  return {SolverKind::Eigen, SolverKind::Spectral};
#endif
}

std::string_view name_of(SolverKind kind) {
  switch (kind) {
    case SolverKind::Cholmod:
      return "cholmod";
    case SolverKind::Eigen:
      return "eigen";
    default:
      return "spectral";
  }
}

std::unique_ptr<LinearSolver> make_solver(SolverKind kind, MemoryBudget* budget) {
#ifdef PLIANT_WITH_CHOLMOD
  if (kind == SolverKind::Cholmod) return make_cholmod_solver(budget);
#endif
  if (kind == SolverKind::Spectral) return make_spectral_solver(budget);
  PLIANT_EXPECTS(kind == SolverKind::Eigen);
  return make_eigen_solver(budget);
}

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
