#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "pliant/feedback/scene_look.hpp"
#include "pliant/feedback/warnings.hpp"
#include "pliant/sampling/sampling.hpp"
#include "pliant/sampling/targets.hpp"
#include "pliant/scene/channels.hpp"

namespace pliant {
namespace {

using Kind = Warning::Kind;

// The warnings that tell why nothing moves, if nothing does.
constexpr std::array reasons_to_stand = {
    Kind::RegionTooSmall, Kind::LostNodes,     Kind::OutsideRegion,
    Kind::SelectsNothing, Kind::PushesNothing, Kind::NeverStarts,
    Kind::AllHeld,        Kind::BetweenNodes,  Kind::LoosePatch};

// Why a surface stands still.
struct Stillness {
  // The nearest one last.
  enum class Reason { Disabled, NeverMoves, NoMagnitude, KeysOutside, Seconds };
  Reason reason = Reason::Disabled;
  std::string force;
  std::string text;
  std::string channel = {};
};

// All keys of each thing by its name.
using KeysByName = std::map<std::string, KeySpan, std::less<>>;

void add_keys(std::optional<KeySpan>& all, const std::optional<KeySpan>& keys) {
  if (!keys) return;
  if (!all) all = KeySpan{keys->first, keys->last};
  all->first = std::min(all->first, keys->first);
  all->last = std::max(all->last, keys->last);
  all->count += keys->count;
}

KeysByName keys_by_name(const Scene& scene) {
  KeysByName by_name;
  for (const NamedChannel& channel : channels_of(scene)) {
    const std::optional<KeySpan> keys = keys_of(channel);
    if (!keys) continue;
    const std::string name = channel.path.substr(0, channel.path.find('.'));
    const auto found = by_name.find(name);
    std::optional<KeySpan> all;
    if (found != by_name.end()) all = found->second;
    add_keys(all, keys);
    by_name.insert_or_assign(name, *all);
  }
  return by_name;
}

// Those of a force and of its group; null: they have none.
std::optional<KeySpan> keys_of(const KeysByName& by_name, const Force& force, const Group* group) {
  std::optional<KeySpan> all;
  for (const std::string& name : {force.name, group ? group->name : std::string()}) {
    const auto found = by_name.find(name);
    if (found != by_name.end()) add_keys(all, found->second);
  }
  return all;
}

// Null: it may act at some frame.
std::optional<Stillness> stillness_of(const Scene& scene, const KeysByName& all_keys,
                                      const Surface& surface, const Force& force,
                                      const Group* group) {
  using enum Stillness::Reason;
  const FrameSpan played = sampled_frames(scene, surface);
  FrameSpan frames = solved_frames(played);
  const bool is_same_always = !force.enabled.is_animated() && !force.magnitude.is_animated() &&
                              !(group && group->enabled.is_animated());
  if (is_same_always) frames.last = frames.first;
  bool is_ever_enabled = false, has_magnitude = false;
  for (int frame = frames.first; frame <= frames.last; ++frame) {
    if (!is_enabled(force, group, frame)) continue;
    is_ever_enabled = true;
    if (force.magnitude.at(frame)[0] == 0) continue;
    has_magnitude = true;
    break;
  }
  const auto told = [&](Stillness::Reason reason, std::string text, std::string channel = {}) {
    return Stillness{reason, force.name, std::move(text), std::move(channel)};
  };
  if (has_magnitude) {
    if (!is_inertia(force) || !stands_still(surface, played)) return {};
    return told(NeverMoves, fmt::format("\"{}\" is its inertia, and it never moves", force.name));
  }
  const auto keys = keys_of(all_keys, force, group);
  if (keys && keys->count >= 2 && keys->first >= 0 && keys->last < 10 && played.last > keys->last &&
      played.count() > 10) {
    return told(Seconds,
                fmt::format("the keys of \"{}\" lie {}, as if they were seconds, but they count in "
                            "frames: {:.6g} frames are a second",
                            force.name, keys->text(), scene.fps));
  }
  const auto outside = [&](const std::string& name, const char* attribute,
                           const auto& channel) -> std::optional<Stillness> {
    const auto own = keys_of(channel);
    if (!own || !own->is_outside(played)) return {};
    return told(KeysOutside,
                fmt::format("the keys of {0}.{1} are outside the frames {2} to {3} that are "
                            "played, {4}; move them, or change start and end",
                            name, attribute, played.first, played.last, own->text()),
                name + '.' + attribute);
  };
  if (auto found = outside(force.name, "magnitude", force.magnitude)) return found;
  if (auto found = outside(force.name, "enabled", force.enabled)) return found;
  if (group) {
    if (auto found = outside(group->name, "enabled", group->enabled)) return found;
  }
  if (!is_ever_enabled) {
    const bool is_by_group = group && !is_on(group->enabled);
    return told(Disabled, fmt::format("{} \"{}\" is disabled; enabled=\"true\" lets it act",
                                      is_by_group ? "group" : "force",
                                      is_by_group ? group->name : force.name));
  }
  return told(NoMagnitude,
              fmt::format("the magnitude of \"{}\" is 0 in all of them; give it one", force.name));
}

// Null: a force may act, or none is there.
std::optional<Stillness> stillness_of(const Scene& scene, const KeysByName& all_keys,
                                      const Surface& surface, const SurfaceTargets& targets) {
  std::optional<Stillness> nearest;
  for (const SurfaceTargets::Member& member : targets.forces) {
    const Force& force = scene.forces[member.force];
    const auto one = stillness_of(scene, all_keys, surface, force, targets.group_of(member, scene));
    if (!one) return {};
    if (!nearest || one->reason > nearest->reason) nearest = one;
  }
  return nearest;
}

bool has_tangents(const TangentChannels& tangents) {
  const auto is_zero = [](const TangentChannel& tangent) {
    return std::visit(
        [](const auto& channel) {
          return !channel.is_animated() &&
                 std::ranges::all_of(channel.at(0), [](double value) { return value == 0; });
        },
        tangent);
  };
  return !is_zero(tangents.su0) || !is_zero(tangents.su1) || !is_zero(tangents.sv0) ||
         !is_zero(tangents.sv1);
}

bool can_move(const Scene& scene, const Surface& surface, const SurfaceTargets& targets) {
  return is_solved(surface) && !targets.forces.empty() && scene.end > scene.start;
}

// The surfaces on which forces are meant to act. One without targets is meant to act on some.
std::set<std::string_view> named_targets(const Scene& scene) {
  std::set<std::string_view> names;
  if (scene.surfaces.size() == 1) names.insert(scene.surfaces.front().name);
  std::set<std::string_view> used;  // groups
  for (const Force& force : scene.forces) {
    names.insert(force.targets.begin(), force.targets.end());
    used.insert(force.group);
  }
  for (const Group& group : scene.groups)
    if (used.contains(group.name)) names.insert(group.targets.begin(), group.targets.end());
  return names;
}

// What nothing moved, told once for each reason.
class StillSurfaces {
 public:
  void add(const Surface& surface, Stillness why) {
    const auto [found, is_new] = numbers_.emplace(why.text, all_.size());
    if (is_new) all_.push_back({std::move(why), {}});
    all_[found->second].surfaces.push_back(&surface);
  }

  // Adds them to the warnings, in place of what tells the same.
  void tell(std::vector<Warning>& warnings, const Scene& scene) && {
    std::set<std::string_view> channels, unmoved_inertia;
    for (const One& one : all_) {
      if (!one.why.channel.empty()) channels.insert(one.why.channel);
      if (one.why.reason == Stillness::Reason::NeverMoves) unmoved_inertia.insert(one.why.force);
    }
    std::erase_if(warnings, [&](const Warning& warning) {
      return (warning.kind == Kind::KeysOutside && channels.contains(warning.channel)) ||
             (warning.kind == Kind::NeverMoves && unmoved_inertia.contains(warning.force));
    });
    for (One& one : all_) {
      Warning& warning = warnings.emplace_back();
      warning.kind = Kind::NothingMoved;
      warning.surface = one.surfaces.front()->name;
      warning.force = std::move(one.why.force);
      warning.told = fmt::format("{}: {}", names_text(one.surfaces), one.why.text);
      warning.channel = std::move(one.why.channel);
      warning.frames = ranges_of({scene.start, scene.end});
    }
  }

 private:
  struct One {
    Stillness why;
    std::vector<const Surface*> surfaces;
  };
  std::vector<One> all_;
  std::map<std::string, std::size_t> numbers_;  // by their texts
};

}  // namespace

void add_still_surfaces(std::vector<Warning>& warnings, const Scene& scene) {
  const std::vector<SurfaceTargets> targets = targets_of(scene);
  const KeysByName all_keys = keys_by_name(scene);
  std::vector<std::optional<Stillness>> reasons(scene.surfaces.size());
  bool may_move = false;  // some surface
  for (std::size_t k = 0; k < scene.surfaces.size(); ++k) {
    const Surface& surface = scene.surfaces[k];
    if (!can_move(scene, surface, targets[k])) continue;
    if (!has_tangents(surface.tangents) && surface.solver.reference == Reference::Rest)
      reasons[k] = stillness_of(scene, all_keys, surface, targets[k]);
    may_move = may_move || !reasons[k];
  }
  const std::set<std::string_view> named = named_targets(scene);
  StillSurfaces still;
  for (std::size_t k = 0; k < reasons.size(); ++k) {
    const Surface& surface = scene.surfaces[k];
    if (reasons[k] && (!may_move || named.contains(surface.name)))
      still.add(surface, *std::move(reasons[k]));
  }
  std::move(still).tell(warnings, scene);
}

void add_still_surfaces(std::vector<Warning>& warnings, const Scene& scene,
                        const std::vector<bool>& has_moved) {
  const std::vector<SurfaceTargets> targets = targets_of(scene);
  const KeysByName all_keys = keys_by_name(scene);
  const std::set<std::string_view> named = named_targets(scene);
  const bool has_any = std::ranges::find(has_moved, true) != has_moved.end();
  std::map<std::string_view, Warning*> told;  // the first reason by surface
  for (Warning& warning : warnings) {
    if (std::ranges::find(reasons_to_stand, warning.kind) != reasons_to_stand.end())
      told.emplace(warning.surface, &warning);
  }
  StillSurfaces still;
  for (std::size_t k = 0; k < scene.surfaces.size(); ++k) {
    const Surface& surface = scene.surfaces[k];
    if (has_moved[k] || !can_move(scene, surface, targets[k]) ||
        (has_any && !named.contains(surface.name))) {
      continue;
    }
    if (auto why = stillness_of(scene, all_keys, surface, targets[k])) {
      still.add(surface, *std::move(why));
      continue;
    }
    // What a force that may act tells is the reason.
    auto reason = told.find(surface.name);
    if (reason == told.end()) reason = told.find("");
    if (reason != told.end()) {
      reason->second->is_still = true;
      continue;
    }
    const std::string& force = scene.forces[targets[k].forces.front().force].name;
    still.add(surface, {.force = force,
                        .text = fmt::format("no node that moves is selected and pushed, by \"{}\" "
                                            "or another force",
                                            force)});
  }
  std::move(still).tell(warnings, scene);
}

}  // namespace pliant
