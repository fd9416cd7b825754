#pragma once

#include <cstddef>
#include <string_view>

#include "pliant/forces/force.hpp"
#include "pliant/scene/format/attribute.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

// In the order of its values.
inline constexpr std::string_view falloff_words[] = {"constant", "linear", "smooth", "gaussian"};
inline constexpr std::string_view push_along_words[] = {"free", "normal"};

// What an element says that is stored in several members of a thing; `Of` is the thing, const or
// not.

/// The forces of a scene that are in no group, and its groups, in the order of its file.
template <class Of>
struct ActingIn {
  Of& scene;
};

/// A group of a scene.
template <class Of>
struct GroupIn {
  Of& scene;
  std::size_t index;  ///< in scene.groups
  std::size_t first;  ///< of its forces, in scene.forces
};

/// The forces in a group of a scene.
template <class Of>
struct MembersOf {
  Of& scene;
  std::size_t group;
  std::size_t first;
};

// Rows that forces and groups share.
inline constexpr Attribute targets_attribute{.name = "targets",
                                             .meaning = "the surfaces it acts on",
                                             .absent = "all surfaces",
                                             .syntax = Syntax::Surface};
inline constexpr Attribute follow_attribute{
    .name = "follow",
    .meaning =
        "the surface in whose object space its places and directions are; it rides on the "
        "surface's transform, or on its cache",
    .absent = "the world",
    .syntax = Syntax::Surface};
inline constexpr Attribute deformation_radius_attribute{
    .name = "deformationRadius",
    .meaning = "nearer vertices select the region that is solved",
    .unit = "length",
    .range = not_negative};

/// What every kind of force has; the rows of its kind follow.
template <>
struct Description<Force> {
  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(name_attribute("name for channels and messages"), of.name...);
    row(Attribute{.name = "enabled",
                  .meaning = "a disabled force selects nothing and pushes nothing"},
        of.enabled...);
    row(targets_attribute, of.targets...);
    row(Attribute{.name = "magnitude",
                  .meaning = "strength; a negative one reverses the force",
                  .unit = "length/uv⁴"},
        of.magnitude...);
    row(deformation_radius_attribute, of.deformation_radius...);
    row(Attribute{.name = "forceRadius",
                  .meaning = "nearer vertices select the box that is pushed",
                  .unit = "length",
                  .range = not_negative},
        of.force_radius...);
    row(Attribute{.name = "falloff",
                  .meaning = "decrease of the strength over distance / `forceRadius`",
                  .words = falloff_words},
        of.falloff...);
  }

  /// What only some kinds have.
  template <class Kind, class Row, class... Of>
  static void rows_of(Row&& row, Of&... of) {
    if constexpr (requires { Description<Kind>::has_place; }) row(follow_attribute, of.follow...);
    if constexpr (requires { Description<Kind>::has_direction; })
      row(Attribute{.name = "along",
                    .meaning = "`free`: it pushes as it is; `normal`: only its part along the "
                               "normal of the surface pushes",
                    .words = push_along_words},
          of.along...);
  }

  template <class Visit, class Of>
  static void children(Visit&& child, Of& force) {
    child(Child{}, force.falloff_curve);
  }
};

template <>
struct Description<Group> {
  static constexpr std::string_view element = "group";
  static constexpr std::string_view meaning = "Forces that share one region.";
  static constexpr bool may_include = true;

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(name_attribute("name for channels and messages"), of.name...);
    row(Attribute{.name = "enabled",
                  .meaning = "a disabled group selects nothing, and its forces push nothing"},
        of.enabled...);
    row(targets_attribute, of.targets...);
    row(follow_attribute, of.follow...);
    row(Attribute{.name = "center", .meaning = "centre of the region", .unit = "length"},
        of.center...);
    row(deformation_radius_attribute, of.deformation_radius...);
  }
};

template <class Of>
struct Description<GroupIn<Of>> : Description<Group> {
  template <class Row, class... Each>
  static void rows(Row&& row, Each&... each) {
    describe(row, each.scene.groups[each.index]...);
  }

  template <class Visit>
  static void children(Visit&& child, const GroupIn<Of>& of) {
    child(Child{.most = unlimited}, MembersOf<Of>{of.scene, of.index, of.first});
  }
};

// The kinds of forces. `Sampled` is the kind at one frame: its members have the same names. Kinds
// without it are sampled in sampling/sampling.cpp. A kind that `has_place` may follow a surface,
// one that `has_direction` may push along normals.

inline constexpr std::string_view push_direction =
    "direction of the push; its length does not matter";

template <>
struct Description<PointChannels> {
  static constexpr std::string_view element = "point";
  static constexpr std::string_view meaning =
      "A force that pushes along a direction, near its centre.";
  using Sampled = PointForce;
  static constexpr bool has_place = true, has_direction = true;

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "center", .meaning = "position of the force", .unit = "length"},
        of.center...);
    row(Attribute{.name = "direction", .meaning = push_direction, .unit = "1"}, of.direction...);
  }
};

template <>
struct Description<RadialChannels> {
  static constexpr std::string_view element = "radial";
  static constexpr std::string_view meaning = "A force that pushes away from its centre.";
  using Sampled = RadialForce;
  static constexpr bool has_place = true;

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(
        Attribute{
            .name = "center", .meaning = "centre; the force pushes away from it", .unit = "length"},
        of.center...);
  }
};

template <>
struct Description<LineChannels> {
  static constexpr std::string_view element = "line";
  static constexpr std::string_view meaning = "A force around a segment.";
  using Sampled = LineForce;
  static constexpr bool has_place = true, has_direction = true;

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "from", .meaning = "one end of the segment", .unit = "length"},
        of.from...);
    row(Attribute{.name = "to", .meaning = "the other end", .unit = "length"}, of.to...);
    row(Attribute{.name = "direction",
                  .meaning = "direction of the push; absent: away from the segment",
                  .unit = "1",
                  .absent = "away from the segment"},
        of.direction...);
  }
};

template <>
struct Description<UniformChannels> {
  static constexpr std::string_view element = "uniform";
  static constexpr std::string_view meaning =
      "A force that is the same everywhere, such as gravity or wind.";
  using Sampled = UniformForce;
  static constexpr bool has_direction = true;

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "direction", .meaning = push_direction, .unit = "1"}, of.direction...);
  }
};

template <>
struct Description<VortexChannels> {
  static constexpr std::string_view element = "vortex";
  static constexpr std::string_view meaning = "A force that turns about an axis.";
  using Sampled = VortexForce;
  static constexpr bool has_place = true, has_direction = true;

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "center", .meaning = "a point of the axis", .unit = "length"},
        of.center...);
    row(Attribute{.name = "axis",
                  .meaning = "the axis; its length does not matter. The rotation follows the "
                             "right-hand rule",
                  .unit = "1"},
        of.axis...);
    row(Attribute{.name = "pull",
                  .meaning = "part towards the axis, relative to the rotating part; a negative "
                             "one pushes away",
                  .unit = "1"},
        of.pull...);
  }
};

template <>
struct Description<NoiseChannels> {
  static constexpr std::string_view element = "noise";
  static constexpr std::string_view meaning =
      "A force that differs smoothly from place to place and from time to time.";
  static constexpr bool has_place = true, has_direction = true;

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "center",
                  .meaning = "origin of distances; the pattern moves with it",
                  .unit = "length"},
        of.center...);
    row(Attribute{.name = "frequency",
                  .meaning = "fineness of the pattern; a negative one mirrors it",
                  .unit = "cells/length"},
        of.frequency...);
    row(Attribute{.name = "rate",
                  .meaning = "speed of change; negative: backwards. Each frame adds its rate/fps, "
                             "so a keyed rate never makes the pattern jump",
                  .unit = "cells/s"},
        of.rate...);
    row(
        Attribute{
            .name = "seed", .meaning = "each seed gives another pattern", .absent = "the scene's"},
        of.seed...);
  }
};

template <>
struct Description<InertiaChannels> {
  static constexpr std::string_view element = "inertia";
  static constexpr std::string_view meaning =
      "The effect of the motion of the surface's transform or cache.";
  static constexpr double magnitude = 1;  ///< the default: the effect of the motion itself

  template <class Row, class... Of>
  static void rows(Row&&, Of&...) {}
};

template <>
struct Description<PressureChannels> {
  static constexpr std::string_view element = "pressure";
  static constexpr std::string_view meaning =
      "A force along the normals of the surface, that inflates it or, if it is negative, sucks it "
      "in.";
  using Sampled = PressureForce;
  static constexpr bool has_place = true;

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "center", .meaning = "centre of what is pushed", .unit = "length"},
        of.center...);
  }
};

/// A program's own kind has no element; the command never sees one.
template <>
struct Description<CustomForce> {
  static constexpr std::string_view element = "custom";
  static constexpr std::string_view meaning = "A force of a program.";

  template <class Row, class... Of>
  static void rows(Row&&, Of&...) {}
};

}  // namespace pliant
