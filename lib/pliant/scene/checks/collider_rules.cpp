#include "pliant/scene/checks/collider_rules.hpp"

#include <algorithm>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "pliant/core/shortened.hpp"

namespace pliant::xml {
namespace {

bool may_be_enabled(const Collider& collider) {
  return collider.enabled.is_animated() || collider.enabled.at(0);
}

bool acts_on(const Collider& collider, const Surface& surface) {
  return !surface.is_driven() && may_be_enabled(collider) &&
         (collider.targets.empty() ||
          std::ranges::find(collider.targets, surface.name) != collider.targets.end());
}

// What of a surface does not go with contact; empty: nothing.
struct Obstacle {
  std::string_view attribute = {}, given = {}, reason = {};
};

Obstacle obstacle_of(const Surface& surface) {
  if (surface.solver.integrator == Integrator::Exact)
    return {"integrator", "exact", "what touches has no solution in closed form"};
  if (surface.solver.reference == Reference::None)
    return {"reference", "none", "only what has a shape at rest can meet a collider"};
  return {};
}

}  // namespace

void check_colliders(const Scene& scene, const ChannelFilter& is_sound, Findings& findings) {
  constexpr std::size_t parts_of_surface = 512;
  for (const Collider& collider : scene.colliders) {
    for (const Surface& surface : scene.surfaces) {
      if (findings.is_over(parts_of_surface)) return;
      if (!acts_on(collider, surface)) continue;
      const Obstacle found = obstacle_of(surface);
      const std::string attribute(found.attribute);
      if (attribute.empty() || (is_sound && !is_sound(surface.name, attribute))) continue;
      findings.add_problem(
          scene.origin.at(surface.name, attribute),
          fmt::format("{}.{} is {}, but the collider {} acts on it: {}", surface.name, attribute,
                      in_quotes(found.given), in_quotes(collider.name), found.reason));
    }
  }
}

}  // namespace pliant::xml
