#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace pliant {

/// The solver for the plates of a run. The choice may change the last digits of a result.
enum class SolverChoice {
  Auto,        ///< spectral from `worth_transforming` on, else supernodal
  Spectral,    ///< sine transforms for all rectangles; other outlines as with `Auto`
  Supernodal,  ///< a factor for all plates
  Cholmod,     ///< SuiteSparse's simplicial LDL^T, to compare; only with PLIANT_WITH_CHOLMOD
  Eigen,       ///< SimplicialLDLT, to compare
};

/// The choices that solve all rectangles in one way, as far as this build supports them. The first
/// one is that of the factors with `Auto`.
std::vector<SolverChoice> available_solvers();

/// Whether this build supports it.
bool is_available(SolverChoice choice);

/// auto, spectral, supernodal, cholmod, eigen.
std::string_view name_of(SolverChoice choice);

/// The choice of that name; nullopt for other names.
std::optional<SolverChoice> solver_choice(std::string_view name);

/// The work that a solver has done so far; shows whether work was reused.
struct SolverCounts {
  long analyses = 0;        ///< orderings and symbolic factorisations
  long factorizations = 0;  ///< numeric factorisations
  long solves = 0;          ///< right-hand sides of three columns

  friend SolverCounts operator+(const SolverCounts& a, const SolverCounts& b) {
    return {a.analyses + b.analyses, a.factorizations + b.factorizations, a.solves + b.solves};
  }
};

}  // namespace pliant
