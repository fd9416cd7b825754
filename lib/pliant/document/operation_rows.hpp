#pragma once

#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

#include "pliant/document/operation.hpp"
#include "pliant/scene/format/attribute.hpp"

namespace pliant {

// The operations of a `SceneDocument`, described once: a row for each of their members, with the
// name that JSON has for it. Reading and writing JSON is made from these rows, and so may be what
// another language has of the operations. A new member is a row here; a new operation a
// `Description`.

inline constexpr std::string_view side_words[] = {"in", "out", "both"};       // edit::Side
inline constexpr std::string_view collision_words[] = {"refuse", "replace"};  // edit::Collision

/// Calls `visit(std::type_identity<Of>())` for each kind of operation.
template <class Visit, class... Each>
void for_each_kind(Visit&& visit, std::type_identity<std::variant<Each...>>) {
  (visit(std::type_identity<Each>()), ...);
}
template <class Visit>
void for_each_operation(Visit&& visit) {
  for_each_kind(visit, std::type_identity<Operation>());
}

// Rows that operations share.
inline constexpr Attribute channel_row{
    .name = "channel", .meaning = "path of what has keys", .need = Need::Required};
inline constexpr Attribute channels_row{
    .name = "channels", .meaning = "paths of what has keys", .need = Need::Required};
inline constexpr Attribute keys_row{
    .name = "keys", .meaning = "keys of channels, by their frames", .need = Need::Required};
inline constexpr Attribute curve_row{
    .name = "curve",
    .meaning = "text of an `<animate>` with its keys; the attribute that it names does not count",
    .need = Need::Required};
inline constexpr Attribute given_row{.name = "attributes", .meaning = "attributes that are given"};

inline constexpr Attribute collision_row{
    .name = "collision",
    .meaning = "what to do with a key at a frame that another comes to",
    .words = collision_words};

inline constexpr Attribute digits_row{
    .name = "digits",
    .meaning = "significant ones to which numbers are rounded; 0: all",
    .range = not_negative};

constexpr Attribute frame_row(std::string_view name, std::string_view meaning,
                              Need need = Need::Required) {
  return {.name = name, .meaning = meaning, .unit = "frame", .need = need};
}

constexpr Attribute required(std::string_view name, std::string_view meaning) {
  return {.name = name, .meaning = meaning, .need = Need::Required};
}

template <>
struct Description<edit::KeysOf> {
  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(channel_row, of.channel...);
    row(frame_row("frames", "where there are keys"), of.frames...);
  }
};

template <>
struct Description<edit::Given> {
  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(required("attribute", "name of an attribute"), of.first...);
    row(required("value", "its value"), of.second...);
  }
};

// Values.

template <>
struct Description<edit::Set> {
  static constexpr std::string_view name = "set";
  static constexpr std::string_view meaning = "Gives a constant value.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(required("path", "of an attribute, or of a component of a constant vector"), of.path...);
    row(required("value", "the value"), of.value...);
  }
};

template <>
struct Description<edit::Reset> {
  static constexpr std::string_view name = "reset";
  static constexpr std::string_view meaning = "Gives the default value.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(required("path", "of an attribute"), of.path...);
  }
};

template <>
struct Description<edit::Animate> {
  static constexpr std::string_view name = "animate";
  static constexpr std::string_view meaning = "Makes curves of one key of constant values.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(channels_row, of.channels...);
    row(frame_row("frame", "of the keys"), of.frame...);
  }
};

template <>
struct Description<edit::Freeze> {
  static constexpr std::string_view name = "freeze";
  static constexpr std::string_view meaning = "Puts constant values in place of curves or paths.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(channels_row, of.channels...);
    row(frame_row("frame", "whose values stay"), of.frame...);
  }
};

template <>
struct Description<edit::SetPart> {
  static constexpr std::string_view name = "setPart";
  static constexpr std::string_view meaning = "Gives a whole part of a surface or collider.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(required("surface", "name of a surface or collider"), of.surface...);
    row(required("part", "`transform`; of a surface also `material`, `tangents` or `solver`"),
        of.part...);
    row(Attribute{.name = "attributes",
                  .meaning = "all attributes that it has then",
                  .need = Need::Required},
        of.attributes...);
    row(Attribute{.name = "comment",
                  .meaning = "lines that stand before it, in place of the comment there"},
        of.comment...);
  }
};

// Keys.

template <>
struct Description<edit::SetKey> {
  static constexpr std::string_view name = "setKey";
  static constexpr std::string_view meaning = "Changes the value of a key, or adds one.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(channel_row, of.channel...);
    row(frame_row("frame", "of the key"), of.frame...);
    row(Attribute{.name = "value", .meaning = "the value", .absent = "that of the curve"},
        of.value...);
  }
};

template <>
struct Description<edit::DeleteKeys> {
  static constexpr std::string_view name = "deleteKeys";
  static constexpr std::string_view meaning = "Deletes keys, but not all of a channel.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(keys_row, of.keys...);
  }
};

template <>
struct Description<edit::MoveKeys> {
  static constexpr std::string_view name = "moveKeys";
  static constexpr std::string_view meaning = "Moves keys by frames and values.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(keys_row, of.keys...);
    row(frame_row("frames", "later by so many", Need::Optional), of.frames...);
    row(Attribute{.name = "rise",
                  .meaning = "higher by so much: a number for all components, or one for each"},
        of.rise...);
    row(collision_row, of.collision...);
    row(digits_row, of.digits...);
  }
};

template <>
struct Description<edit::ScaleKeys> {
  static constexpr std::string_view name = "scaleKeys";
  static constexpr std::string_view meaning = "Scales keys in time and in value.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(keys_row, of.keys...);
    row(frame_row("frame", "that stays", Need::Optional), of.frame...);
    row(
        Attribute{
            .name = "timeFactor", .meaning = "of the time to it", .unit = "1", .range = positive},
        of.time_factor...);
    row(Attribute{.name = "value",
                  .meaning = "that stays: a number for all components, or one for each",
                  .absent = "0"},
        of.value...);
    row(Attribute{.name = "valueFactor",
                  .meaning = "of the distance to it: a number for all components, or one for each",
                  .unit = "1",
                  .absent = "1"},
        of.value_factor...);
    row(Attribute{.name = "step",
                  .meaning = "of which new frames are multiples; 0: they are as they come",
                  .unit = "frame",
                  .range = not_negative},
        of.step...);
    row(collision_row, of.collision...);
    row(digits_row, of.digits...);
  }
};

template <>
struct Description<edit::SetTangent> {
  static constexpr std::string_view name = "setTangent";
  static constexpr std::string_view meaning = "Gives keys tangents.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(keys_row, of.keys...);
    row(Attribute{.name = "side", .meaning = "of the keys", .words = side_words}, of.side...);
    row(Attribute{.name = "tangent",
                  .meaning = "their kind or slope, as `tangent` of a `<key>`",
                  .absent = "as it is"},
        of.tangent...);
    row(Attribute{.name = "length",
                  .meaning = "how far they reach, as `inLength` of a `<key>`",
                  .absent = "as it is"},
        of.length...);
  }
};

template <>
struct Description<edit::SetHandle> {
  static constexpr std::string_view name = "setHandle";
  static constexpr std::string_view meaning = "Gives a key a handle.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(channel_row, of.channel...);
    row(frame_row("frame", "of the key"), of.frame...);
    row(Attribute{.name = "side",
                  .meaning = "of the key: `in` or `out`",
                  .words = std::span(side_words).first(2)},
        of.side...);
    row(required("handle", "frames and values from the key, as `outHandle` of a `<key>`"),
        of.handle...);
  }
};

template <>
struct Description<edit::SetInterpolation> {
  static constexpr std::string_view name = "setInterpolation";
  static constexpr std::string_view meaning =
      "Gives the segments that start at keys another shape.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    constexpr auto parameter = [](std::string_view name) {
      return Attribute{.name = name, .meaning = "as of a `<key>`", .absent = "as it is"};
    };
    row(keys_row, of.keys...);
    row(required("interpolation", "as of a `<key>`"), of.interpolation...);
    row(parameter("amplitude"), of.amplitude...);
    row(parameter("period"), of.period...);
    row(parameter("back"), of.back...);
    row(parameter("control"), of.control...);
  }
};

template <>
struct Description<edit::SetExtrapolation> {
  static constexpr std::string_view name = "setExtrapolation";
  static constexpr std::string_view meaning = "Gives the values outside the keys.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    constexpr auto side = [](std::string_view name) {
      return Attribute{.name = name, .meaning = "as of an `<animate>`", .absent = "as it is"};
    };
    row(channels_row, of.channels...);
    row(side("before"), of.before...);
    row(side("after"), of.after...);
  }
};

template <>
struct Description<edit::BakeKeys> {
  static constexpr std::string_view name = "bakeKeys";
  static constexpr std::string_view meaning = "Makes the same curves of keys at even frames.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(channels_row, of.channels...);
    row(frame_row("first", "of the first key"), of.first...);
    row(frame_row("last", "of the last key"), of.last...);
    row(frame_row("step", "from one key to the next", Need::Optional), of.step...);
    row(Attribute{.name = "isLinear", .meaning = "between the keys; otherwise `bezier`"},
        of.is_linear...);
  }
};

template <>
struct Description<edit::SimplifyKeys> {
  static constexpr std::string_view name = "simplifyKeys";
  static constexpr std::string_view meaning = "Makes nearly the same curves of fewer keys.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(channels_row, of.channels...);
    row(required("tolerance", "the most that a value may change"), of.tolerance...);
    row(Attribute{.name = "first",
                  .meaning = "where keys may go, from here",
                  .unit = "frame",
                  .absent = "the first key"},
        of.first...);
    row(Attribute{.name = "last", .meaning = "to here", .unit = "frame", .absent = "the last key"},
        of.last...);
  }
};

template <>
struct Description<edit::Scale> {
  static constexpr std::string_view name = "scale";
  static constexpr std::string_view meaning = "Multiplies the values of channels.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(channels_row, of.channels...);
    row(
        Attribute{
            .name = "factor", .meaning = "of the values", .unit = "1", .need = Need::Required},
        of.factor...);
    row(digits_row, of.digits...);
  }
};

template <>
struct Description<edit::SetCurve> {
  static constexpr std::string_view name = "setCurve";
  static constexpr std::string_view meaning = "Gives a channel a whole curve.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(channel_row, of.channel...);
    row(curve_row, of.keys...);
  }
};

template <>
struct Description<edit::Splice> {
  static constexpr std::string_view name = "splice";
  static constexpr std::string_view meaning =
      "Puts a piece of a curve in place of the keys from one frame to another.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(channel_row, of.channel...);
    row(frame_row("first", "keys give way from here"), of.first...);
    row(frame_row("last", "to here"), of.last...);
    row(curve_row, of.keys...);
  }
};

// Surfaces, forces, groups and colliders.

template <>
struct Description<edit::Add> {
  static constexpr std::string_view name = "add";
  static constexpr std::string_view meaning = "Adds a surface, a force, a group or a collider.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(required("kind", "`surface`, `group`, `collider`, or that of a force, such as `point`"),
        of.kind...);
    row(required("name", "a new name"), of.name...);
    row(given_row, of.attributes...);
    row(Attribute{.name = "group", .meaning = "of a force; empty: none"}, of.group...);
    row(Attribute{.name = "shape",
                  .meaning = "of a surface or collider, such as `mesh`; empty: `grid` or `sphere`"},
        of.shape...);
  }
};

template <>
struct Description<edit::Duplicate> {
  static constexpr std::string_view name = "duplicate";
  static constexpr std::string_view meaning = "Adds a copy behind an object.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(required("object", "name of a surface, force, group or collider"), of.object...);
    row(required("name", "of the copy"), of.name...);
  }
};

template <>
struct Description<edit::Delete> {
  static constexpr std::string_view name = "delete";
  static constexpr std::string_view meaning = "Deletes objects, also where they are named.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(required("objects", "names of surfaces, forces, groups or colliders"), of.objects...);
  }
};

template <>
struct Description<edit::Rename> {
  static constexpr std::string_view name = "rename";
  static constexpr std::string_view meaning =
      "Gives an object another name, also in what names it.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(required("object", "name of a surface, force, group or collider"), of.object...);
    row(required("name", "a new name"), of.name...);
  }
};

template <>
struct Description<edit::Target> {
  static constexpr std::string_view name = "target";
  static constexpr std::string_view meaning =
      "Gives forces, groups or colliders the surfaces they act on.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(required("objects", "names of forces, groups or colliders"), of.objects...);
    row(required("surfaces", "names of surfaces; none: all"), of.surfaces...);
  }
};

template <>
struct Description<edit::Group> {
  static constexpr std::string_view name = "group";
  static constexpr std::string_view meaning = "Puts forces into a group.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(required("forces", "names of forces"), of.forces...);
    row(required("name", "of the group, which may be there already"), of.name...);
    row(given_row, of.attributes...);
  }
};

template <>
struct Description<edit::Ungroup> {
  static constexpr std::string_view name = "ungroup";
  static constexpr std::string_view meaning = "Puts the forces of groups in the place of these.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(required("groups", "names of groups"), of.groups...);
  }
};

}  // namespace pliant
