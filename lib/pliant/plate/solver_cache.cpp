#include "pliant/plate/solver_cache.hpp"

#include <algorithm>
#include <utility>

namespace pliant {

void SolverCache::keep_only(std::span<const Outline> outlines) {
  std::erase_if(kept_, [&](const Kept& kept) {
    if (std::find(outlines.begin(), outlines.end(), kept.outline) != outlines.end()) return false;
    gone_ = gone_ + kept.solver->counts();
    return true;
  });
}

PlateSolver& SolverCache::solver_of(const Outline& outline) {
  const auto found = std::find_if(kept_.begin(), kept_.end(),
                                  [&](const Kept& kept) { return kept.outline == outline; });
  if (found != kept_.end()) return *found->solver;
  kept_.push_back({outline, make_plate_solver(choice_, context_)});
  return *kept_.back().solver;
}

SolverCounts SolverCache::counts() const {
  SolverCounts total = gone_;
  for (const Kept& kept : kept_) total = total + kept.solver->counts();
  return total;
}

}  // namespace pliant
