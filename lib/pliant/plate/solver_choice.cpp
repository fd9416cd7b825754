#include "pliant/plate/solver_choice.hpp"

#include <algorithm>

#include "pliant/core/expects.hpp"
#include "pliant/plate/sparse/sparse_factor.hpp"

namespace pliant {

std::vector<SolverChoice> available_solvers() {
  return {SolverChoice::Supernodal,
#ifdef PLIANT_WITH_CHOLMOD
          SolverChoice::Cholmod,
#endif
          SolverChoice::Eigen, SolverChoice::Spectral};
}

bool is_available(SolverChoice choice) {
  const auto available = available_solvers();
  return choice == SolverChoice::Auto ||
         std::find(available.begin(), available.end(), choice) != available.end();
}

std::string_view name_of(SolverChoice choice) {
  switch (choice) {
    case SolverChoice::Auto:
      return "auto";
    case SolverChoice::Spectral:
      return "spectral";
    case SolverChoice::Supernodal:
      return "supernodal";
    case SolverChoice::Cholmod:
      return "cholmod";
    default:
      return "eigen";
  }
}

std::optional<SolverChoice> solver_choice(std::string_view name) {
  for (const SolverChoice choice :
       {SolverChoice::Auto, SolverChoice::Spectral, SolverChoice::Supernodal, SolverChoice::Cholmod,
        SolverChoice::Eigen}) {
    if (name_of(choice) == name) return choice;
  }
  return {};
}

std::unique_ptr<SparseFactor> make_sparse_factor(SolverChoice choice, const RunContext& context) {
  if (choice == SolverChoice::Supernodal) return make_supernodal_factor(context);
#ifdef PLIANT_WITH_CHOLMOD
  if (choice == SolverChoice::Cholmod) return make_cholmod_factor();
#endif
  PLIANT_EXPECTS(choice == SolverChoice::Eigen);
  return make_eigen_factor();
}

}  // namespace pliant
