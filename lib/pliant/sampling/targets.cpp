#include "pliant/sampling/targets.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <string_view>

namespace pliant {
namespace {

class Surfaces {
 public:
  explicit Surfaces(const Scene& scene) {
    for (std::size_t k = 0; k < scene.surfaces.size(); ++k) {
      if (scene.surfaces[k].is_driven()) continue;
      all_.push_back(k);
      named_.emplace(scene.surfaces[k].name, k);
    }
  }

  // The surfaces with these names that are solved, in the order of the scene; no names: all.
  std::vector<std::size_t> of(const std::vector<std::string>& targets) const {
    if (targets.empty()) return all_;
    std::vector<std::size_t> found;
    for (const std::string& target : targets) {
      if (const auto named = named_.find(target); named != named_.end()) {
        found.push_back(named->second);
      }
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

 private:
  std::vector<std::size_t> all_;
  std::map<std::string_view, std::size_t> named_;
};

// The surfaces on which a group acts, and its index among the groups of each.
struct GroupPlaces {
  std::vector<std::size_t> surfaces = {};  // ascending
  std::vector<int> places = {};            // one for each surface

  int place_at(std::size_t surface) const {
    const auto found = std::lower_bound(surfaces.begin(), surfaces.end(), surface);
    return found != surfaces.end() && *found == surface ? places[found - surfaces.begin()] : -1;
  }
};

}  // namespace

std::vector<SurfaceTargets> targets_of(const Scene& scene) {
  std::vector<SurfaceTargets> targets(scene.surfaces.size());
  const Surfaces surfaces(scene);
  std::map<std::string_view, GroupPlaces> groups;
  for (std::size_t group = 0; group < scene.groups.size(); ++group) {
    GroupPlaces places{surfaces.of(scene.groups[group].targets)};
    for (const std::size_t surface : places.surfaces) {
      places.places.push_back(static_cast<int>(targets[surface].groups.size()));
      targets[surface].groups.push_back(group);
    }
    groups.emplace(scene.groups[group].name, std::move(places));
  }
  for (std::size_t force = 0; force < scene.forces.size(); ++force) {
    const auto group = groups.find(scene.forces[force].group);
    const bool is_member = group != groups.end();
    for (const std::size_t surface : surfaces.of(scene.forces[force].targets)) {
      const int place = is_member ? group->second.place_at(surface) : -1;
      if (is_member && place < 0) continue;  // the group does not act on this surface
      targets[surface].forces.push_back({force, place});
    }
  }
  for (std::size_t collider = 0; collider < scene.colliders.size(); ++collider) {
    for (const std::size_t surface : surfaces.of(scene.colliders[collider].targets))
      targets[surface].colliders.push_back(collider);
  }
  return targets;
}

}  // namespace pliant
