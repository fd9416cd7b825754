#include "pliant/plate/vibration_cache.hpp"

#include <algorithm>

#include "pliant/plate/vibration.hpp"

namespace pliant {

Result<double> VibrationCache::smallest(PlateSolver& solver, const PlateSystem& system) {
  // A scene rarely has more that come again; a byte for each node of a mask.
  constexpr std::size_t most_known = 64;
  constexpr std::size_t most_mask_nodes = std::size_t{1} << 22;
  const auto found = std::find_if(known_.begin(), known_.end(),
                                  [&](const Known& known) { return known.system == system; });
  if (found != known_.end()) return found->lambda;
  auto lambda = smallest_eigenvalue(solver, system);
  if (!lambda) return lambda;
  known_.push_back({system, *lambda});
  mask_nodes_ += system.outline.mask().size();
  while (known_.size() > most_known || (known_.size() > 1 && mask_nodes_ > most_mask_nodes)) {
    mask_nodes_ -= known_.front().system.outline.mask().size();
    known_.pop_front();
  }
  return lambda;
}

}  // namespace pliant
