#include "pliant/scene/checks/sound_things.hpp"

#include <cstddef>
#include <memory>
#include <tuple>
#include <type_traits>
#include <variant>

#include "pliant/core/hash.hpp"
#include "pliant/core/shelf.hpp"
#include "pliant/scene/format/description.hpp"

namespace pliant {
namespace {

// What the rules read of a scene besides a thing.
struct Times {
  double fps;
  int start;
  FrameSpan frames;

  friend bool operator==(const Times& a, const Times& b) {
    return a.fps == b.fps && a.start == b.start && a.frames.first == b.frames.first &&
           a.frames.last == b.frames.last;
  }
};

// What they read of a thing: all, but no mesh, which may be large.
auto read_by_rules(const Surface& surface) {
  const auto& [name, enabled, driven_by, shape, reading, subdivision, cache, transform, material,
               maps, holds, tangents, solver] = surface;
  return std::tuple(name, enabled, driven_by, reading, transform, material, holds.empty(), tangents,
                    solver);
}
auto read_by_rules(const Collider& collider) {
  const auto& [name, enabled, targets, deformation_radius, offset, friction, stick, shape,
               transform] = collider;
  const bool is_mesh = std::holds_alternative<ClosedMesh>(shape);
  return std::tuple(name, enabled, deformation_radius, offset, friction, stick,
                    is_mesh ? std::decay_t<decltype(shape)>(ClosedMesh()) : shape, transform);
}
template <class Thing>
const Thing& read_by_rules(const Thing& thing) {
  return thing;
}

template <class Thing>
using ReadByRules = std::decay_t<decltype(read_by_rules(std::declval<const Thing&>()))>;

template <class Thing>
struct SoundItem final : Shelf::Item {
  SoundItem(const Times& in, const Thing& thing) : times(in), read(read_by_rules(thing)) {}

  Times times;
  ReadByRules<Thing> read;
};

// A function of a program may hold on to anything.
bool can_be_kept(const Force& force) { return !std::holds_alternative<CustomForce>(force.kind); }
template <class Thing>
bool can_be_kept(const Thing&) {
  return true;
}

template <class Thing>
std::size_t bytes_of(const Thing& thing) {
  std::size_t bytes = sizeof(SoundItem<Thing>);
  for_each_channel(thing, [&]<class C>(const std::string&, const Attribute&, const C& channel) {
    if constexpr (!std::is_same_v<C, Switch>) {
      if (channel.is_animated()) bytes += channel.curve().keys().keys.size() * sizeof(Key<3>);
    }
  });
  return bytes;
}

template <class Visit>
void for_each_thing(const Scene& scene, const Visit& visit) {
  const auto times_of = [&](const FrameSpan& frames) {
    return Times{scene.fps, scene.start, frames};
  };
  for (const Surface& surface : scene.surfaces)
    visit(surface, times_of(sampled_frames(scene, surface)));
  const Times times = times_of(sampled_frames(scene));
  for (const Force& force : scene.forces) visit(force, times);
  for (const Group& group : scene.groups) visit(group, times);
  for (const Collider& collider : scene.colliders) visit(collider, times);
}

}  // namespace

SoundThings::SoundThings(const Scene& scene, Shelf* shelf) : scene_(scene), shelf_(shelf) {
  if (!shelf) return;
  for_each_thing(scene, [&]<class Thing>(const Thing& thing, const Times& times) {
    const auto found =
        shelf->find<SoundItem<Thing>>(hash_of(thing.name), [&](const SoundItem<Thing>& one) {
          return one.times == times && one.read == read_by_rules(thing);
        });
    if (found) known_.insert(thing.name);
  });
}

void SoundThings::add_others() const {
  if (!shelf_) return;
  for_each_thing(scene_, [&]<class Thing>(const Thing& thing, const Times& times) {
    if (contain(thing.name) || !can_be_kept(thing)) return;
    shelf_->keep_instead(hash_of(thing.name), std::make_shared<SoundItem<Thing>>(times, thing),
                         bytes_of(thing));
  });
}

}  // namespace pliant
