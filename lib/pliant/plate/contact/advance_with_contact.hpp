#pragma once

#include <optional>

#include "pliant/plate/contact/complementarity.hpp"
#include "pliant/plate/contact/inverse_columns.hpp"
#include "pliant/plate/plate_solver.hpp"

namespace pliant {

/// What is kept of a plate that meets solids, from frame to frame. No bit depends on it. Internal
/// to plate.
struct ContactMemory {
  explicit ContactMemory(const RunContext& context) : columns(context), problem(columns, context) {}
  ContactMemory(const ContactMemory&) = delete;
  ContactMemory& operator=(const ContactMemory&) = delete;

  /// The matrix is another one.
  void forget();

  /// Keeps only what is of this system.
  void keep_for(const PlateSystem& system);

  std::optional<PlateSystem> system;
  InverseColumns columns;
  Complementarity problem;
};

/// The matrix of a step. Requires: the solver is prepared for it, and outlives it; `shift` are its
/// terms' (#unknowns).
SolvedMatrix contact_matrix(PlateSolver& solver, const PlateProblem& problem, double dt,
                            const Eigen::VectorXd& shift);

/// Advances a plate that meets solids. Steps up to the first in which something touches have the
/// bits of `solver.advance`. A step of Newmark's in which something touches is one of backward
/// Euler, of the same length, which is solved by `whole`; other steps by `solver`, which may be the
/// same if none are Newmark's. Requires: problem.contact; no exact steps; no law. Errors: those of
/// the solvers; SolverFailed if a step does not settle.
Result<PlateState> advance_with_contact(PlateSolver& solver, PlateSolver& whole,
                                        ContactMemory& memory, const PlateProblem& problem,
                                        const TimeSteps& steps, PlateState state);

}  // namespace pliant
