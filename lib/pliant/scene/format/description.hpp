#pragma once

#include <optional>
#include <string>
#include <type_traits>
#include <variant>

#include "pliant/scene/format/collider_description.hpp"
#include "pliant/scene/format/force_description.hpp"
#include "pliant/scene/format/surface_description.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

// The scene format, described once: a row for each attribute of each thing that a scene contains.
// Reading, checking, sampling, lists of channels, state keys, JSON and the tables of
// docs/scene-format.md are made from these rows. A new attribute is a member in scene.hpp and a row
// here; a new kind of force is a struct there and a `Description` here.

template <>
struct Description<Scene> {
  static constexpr std::string_view element = "scene";
  static constexpr std::string_view meaning =
      "A scene: surfaces, the forces on them, and the frames of the animation.";
  static constexpr bool may_include = true;

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{
        .name = "version", .meaning = "version of the format", .syntax = Syntax::Version});
    row(Attribute{.name = "fps",
                  .meaning = "frames in a second: a number or a fraction such as `24000/1001`",
                  .unit = "frames/s",
                  .range = positive,
                  .syntax = Syntax::Rate},
        of.fps...);
    row(Attribute{.name = "start",
                  .meaning = "first frame",
                  .unit = "frame",
                  .range = frame_range,
                  .need = Need::Required},
        of.start...);
    row(Attribute{.name = "end",
                  .meaning = "last frame: not before `start`, and at most 10⁶ frames in all",
                  .unit = "frame",
                  .range = frame_range,
                  .need = Need::Required},
        of.end...);
    row(Attribute{.name = "seed", .meaning = "seed of the noise forces"}, of.seed...);
  }

  template <class Visit, class Of>
  static void children(Visit&& child, Of& scene) {
    child(Child{.most = unlimited}, scene.surfaces);
    child(Child{.most = unlimited}, ActingIn<Of>{scene});
    child(Child{.most = unlimited}, scene.colliders);
  }
};

/// Calls `visit(part)` for a thing and each of its parts: elements that are always there, but for
/// those that a driven surface has not.
template <class T, class Visit>
void for_each_part(T& thing, Visit&& visit);

/// Calls `visit(name, attribute, channel)` for each channel of a thing, a `Channel<1>`,
/// `Channel<3>` or `Switch`; for a position on a path with the name `NAME.progress`.
template <class T, class Visit>
void for_each_channel(T& thing, Visit&& visit);

/// Finds the channels among the members of a thing.
template <class Visit>
struct ChannelFinder {
  Visit& visit;

  void operator()(const Attribute&) const {}
  template <class Member>
  void operator()(const Attribute& attribute, Member& member) const {
    using M = std::remove_const_t<Member>;
    if constexpr (std::is_same_v<M, Channel<1>> || std::is_same_v<M, Channel<3>> ||
                  std::is_same_v<M, Switch>) {
      visit(std::string(attribute.name), attribute, member);
    } else if constexpr (std::is_same_v<M, std::optional<Channel<1>>> ||
                         std::is_same_v<M, std::optional<Channel<3>>>) {
      if (member) (*this)(attribute, *member);
    } else if constexpr (std::is_same_v<M, TangentChannel>) {
      std::visit([&](auto& channel) { (*this)(attribute, channel); }, member);
    } else if constexpr (std::is_same_v<M, PositionChannel>) {
      if (auto* const motion = member.path()) {
        visit(std::string(attribute.name) + ".progress", progress_attribute, motion->progress);
      } else {
        (*this)(attribute, *member.channel());
      }
    }
  }
};

template <class T, class Visit>
void for_each_part(T& thing, Visit&& visit) {
  using Thing = std::remove_const_t<T>;
  visit(thing);
  if constexpr (std::is_same_v<Thing, Force>) std::visit(visit, thing.kind);
  if constexpr (std::is_same_v<Thing, Collider>) std::visit(visit, thing.shape);
  const auto child = [&]([[maybe_unused]] const Child& row, auto&& member) {
    using Member = std::remove_cvref_t<decltype(member)>;
    if constexpr (std::is_same_v<Thing, Surface>) {
      if (thing.is_driven() && !row.is_of_driven) return;
    }
    if constexpr (requires { Description<Member>::element; }) visit(member);
  };
  if constexpr (requires { Description<Thing>::children(child, thing); })
    Description<Thing>::children(child, thing);
}

/// Whether another value stands in place of that of an attribute.
template <class T>
bool is_replaced(const T& thing, const Attribute& attribute) {
  if constexpr (std::is_same_v<T, Surface>)  // the damping follows from its ratio
    return attribute.name == "damping" && thing.material.damping_ratio;
  else if constexpr (std::is_same_v<T, Force>)  // the group selects the region
    return attribute.name == deformation_radius_attribute.name && !thing.group.empty();
  else
    return false;
}

template <class T, class Visit>
void for_each_channel(T& thing, Visit&& visit) {
  const ChannelFinder<std::remove_reference_t<Visit>> finder{visit};
  const auto row = [&](const Attribute& attribute, auto&... member) {
    if (!is_replaced(thing, attribute)) finder(attribute, member...);
  };
  for_each_part(thing, [&](auto& part) { describe(row, part); });
}

}  // namespace pliant
