#include "pliant/plate/solver_cache.hpp"

#include <algorithm>
#include <utility>

namespace pliant {

void SolverCache::keep_only(std::span<const Outline> outlines) {
  std::erase_if(entries_, [&](const Entry& entry) {
    if (std::find(outlines.begin(), outlines.end(), entry.outline) != outlines.end()) return false;
    gone_ = gone_ + entry.solver->counts();
    return true;
  });
}

PlateSolver& SolverCache::solver_of(const Outline& outline) {
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const Entry& entry) { return entry.outline == outline; });
  if (found != entries_.end()) return *found->solver;
  entries_.push_back({outline, make_plate_solver(choice_, context_)});
  return *entries_.back().solver;
}

SolverCounts SolverCache::counts() const {
  SolverCounts total = gone_;
  for (const Entry& entry : entries_) total = total + entry.solver->counts();
  return total;
}

}  // namespace pliant
