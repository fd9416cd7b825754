#pragma once

#include <set>
#include <string>
#include <string_view>

#include "pliant/scene/scene.hpp"

namespace pliant {

class Shelf;

/// The surfaces, forces, groups and colliders of a scene whose channels a shelf knows to keep the
/// rules of `check_channels` at all frames, since they did in another scene.
class SoundThings {
 public:
  /// Requires: the scene and the shelf outlive it. Null: nothing is known.
  SoundThings(const Scene& scene, Shelf* shelf);

  bool contain(std::string_view name) const { return known_.contains(name); }

  /// Lets the shelf know that the others are sound too.
  void add_others() const;

 private:
  const Scene& scene_;
  Shelf* shelf_;
  std::set<std::string, std::less<>> known_;
};

}  // namespace pliant
