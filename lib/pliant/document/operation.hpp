#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "pliant/timeline/key.hpp"

namespace pliant {

// The operations of a `SceneDocument`. A value is the text that a scene file has for it;
// `edit::to_text` writes numbers so. A path is `NAME.attribute`: the name of a surface, force,
// group or collider, or `scene`, and any attribute of its element, its shape or the parts of it,
// such as `sheet.columns`, `sheet.density` or `poke.center.progress`. A channel is the path of what
// has keys; `NAME.falloff` is a force's <falloff>, whose frames are `at`.
namespace edit {

/// The fewest digits that are read as the same double; several numbers are separated by blanks.
std::string to_text(double number);
std::string to_text(const std::vector<double>& numbers);
/// A text in which no `$` stands for a definition.
std::string literal_text(std::string_view text);
template <class Boolean>
requires std::is_same_v<Boolean, bool> std::string to_text(Boolean value) {
  return value ? "true" : "false";
}

// Values.

/// A constant value. It takes the place of an <animate>, <path> or <falloff>. `NAME.center.x` is
/// one component of a vector that is constant.
struct Set {
  std::string path;
  std::string value;
};

/// The default value: removes the attribute, or what animates it.
struct Reset {
  std::string path;
};

/// Curves with one key, at `frame`, in place of constant values.
struct Animate {
  std::vector<std::string> channels;
  double frame = 0;
};

/// The values at `frame` in place of curves, or of a position's path.
struct Freeze {
  std::vector<std::string> channels;
  double frame = 0;
};

/// A part of a surface or collider with exactly these attributes, in place of what it has: a whole
/// <material>, for example. `comment`, if it is not empty, stands before it, one line of the file
/// for each of its own, in place of the comment that stands there.
struct SetPart {
  std::string surface;  ///< or collider
  std::string part;     ///< `transform`; of a surface also `material`, `tangents` or `solver`
  std::vector<std::pair<std::string, std::string>> attributes;
  std::string comment = {};
};

// Keys. A key is named by its frame; there must be one at exactly that frame.

/// Some keys of a channel.
struct KeysOf {
  std::string channel;
  std::vector<double> frames;
};

/// Changes the value of a key, or adds one with the tangents of its <animate> and the interpolation
/// of the segment in which it stands. Without a value, or with that of the curve, the curve keeps
/// its shape; see `insert_key`. A constant value becomes a curve.
struct SetKey {
  std::string channel;
  double frame = 0;
  std::optional<std::string> value = {};
};

/// Deletes keys, but not all of a channel. See `delete_keys`.
struct DeleteKeys {
  std::vector<KeysOf> keys;
};

/// What to do if a key comes to the frame of one that is not moved.
enum class Collision { Refuse, Replace };

/// Moves keys by frames and values; they may pass others.
struct MoveKeys {
  std::vector<KeysOf> keys;
  double frames = 0;
  std::vector<double> rise = {};  ///< none, one number for all components, or one for each
  Collision collision = Collision::Refuse;
  int digits = 0;  ///< significant ones to which each number that rises is rounded; 0: all
};

/// Scales keys in time about `frame` and in value about `value`, with their slopes, handles and
/// lengths; the parameters of a segment if both of its keys are scaled, and what is outside the
/// keys, and the loop, if all are. A curve whose keys are all scaled is as before but for the
/// scale.
struct ScaleKeys {
  std::vector<KeysOf> keys;
  double frame = 0;
  double time_factor = 1;                 ///< [1], > 0
  std::vector<double> value = {};         ///< 0, one number for all components, or one for each
  std::vector<double> value_factor = {};  ///< [1]; 1, one for all components, or one for each
  double step = 0;  ///< new frames are rounded to multiples of it; 0: they are not
  Collision collision = Collision::Refuse;
  int digits = 0;  ///< significant ones to which new values and slopes are rounded; 0: all
};

/// One or both sides of a key.
enum class Side { In, Out, Both };

/// The kind or slope of tangents, as `in`, `out` and `tangent` of a <key> have it, or their length.
/// Null: stays.
struct SetTangent {
  std::vector<KeysOf> keys;
  Side side = Side::Both;
  std::optional<std::string> tangent = {};
  std::optional<std::string> length = {};
};

/// A handle, as `inHandle` and `outHandle` have it. Requires: `side` is one side.
struct SetHandle {
  std::string channel;
  double frame = 0;
  Side side = Side::Out;
  std::string handle;
};

/// The interpolation of the segments that start at keys, with the parameters that it reads; null:
/// as they are.
struct SetInterpolation {
  std::vector<KeysOf> keys;
  std::string interpolation;
  std::optional<std::string> amplitude = {};
  std::optional<std::string> period = {};
  std::optional<std::string> back = {};
  std::optional<std::string> control = {};
};

/// The values outside the keys, as `before` and `after` of an <animate> have it; null: as they are.
struct SetExtrapolation {
  std::vector<std::string> channels;
  std::optional<std::string> before = {};
  std::optional<std::string> after = {};
};

/// The same curves by keys at even frames; see `bake_keys`.
struct BakeKeys {
  std::vector<std::string> channels;
  double first = 0;
  double last = 0;
  double step = 1;
  bool is_linear = false;  ///< between the keys; otherwise bezier
};

/// Fewer keys for nearly the same curves; see `simplify`.
struct SimplifyKeys {
  std::vector<std::string> channels;
  double tolerance = 0;              ///< the most that a value may change [unit]
  std::optional<double> first = {};  ///< absent: all keys
  std::optional<double> last = {};
};

/// The values of channels times a factor: of keys with their slopes and handles, and all else that
/// the curve has in the unit of its channel, or the constant.
struct Scale {
  std::vector<std::string> channels;
  double factor = 1;
  int digits = 0;  ///< significant ones to which each number is rounded; 0: all
};

/// A whole curve in place of what the channel has. Keys at the frames of old ones are written in
/// their place, as far as they differ.
struct SetCurve {
  std::string channel;
  std::variant<CurveKeys<1>, CurveKeys<3>> keys;
};

/// A piece of a curve, such as a recorded one, in place of the keys in [first, last]; its own keys
/// are there too. Keys outside keep their frames, values and shape; see `splice`. A constant value
/// becomes the piece alone. Keys at the frames of old ones are written in their place.
struct Splice {
  std::string channel;
  double first = 0;
  double last = 0;
  std::variant<CurveKeys<1>, CurveKeys<3>> keys;
};

// Surfaces, forces, groups and colliders.

/// An attribute and its value.
using Given = std::pair<std::string, std::string>;

/// Adds one, a surface behind the others, all else at the end. Attributes of a surface or collider
/// stand in its shape or the part that has them.
struct Add {
  std::string kind;  ///< `surface`, `group`, `collider`, or that of a force, such as `point`
  std::string name;
  std::vector<Given> attributes = {};
  std::string group = {};  ///< of a force; empty: none
  /// Of a surface or collider, such as `mesh`; empty: the first that there is, `grid` or `sphere`.
  std::string shape = {};
};

/// A copy behind the original. Forces in a copied group get free names.
struct Duplicate {
  std::string object;
  std::string name;
};

/// Deletes objects, also where they are named, such as targets. Refused if no name would be left
/// there: a force without targets would act on all surfaces.
struct Delete {
  std::vector<std::string> objects;
};

/// Another name, also where it is named: in `targets`, `drivenBy`, `follow`.
struct Rename {
  std::string object;
  std::string name;
};

/// The surfaces on which forces or groups act, or that meet colliders; none: all.
struct Target {
  std::vector<std::string> objects;
  std::vector<std::string> surfaces;
};

/// Puts forces into a group: a new one with these attributes in the place of the first of them, or
/// one that is there already. A new group has the `center` and `deformationRadius` of the first
/// force that has them as constants, unless given. Their own deformation radii are lost.
struct Group {
  std::vector<std::string> forces;
  std::string name;
  std::vector<Given> attributes = {};
};

/// Puts the forces of groups in the place of these. They get the deformation radius of their group,
/// act where both did, and are enabled when both were. Refused if that cannot be said.
struct Ungroup {
  std::vector<std::string> groups;
};

}  // namespace edit

/// One change of a scene file.
using Operation =
    std::variant<edit::Set, edit::Reset, edit::Animate, edit::Freeze, edit::SetKey,
                 edit::DeleteKeys, edit::MoveKeys, edit::ScaleKeys, edit::SetTangent,
                 edit::SetHandle, edit::SetInterpolation, edit::SetExtrapolation, edit::BakeKeys,
                 edit::SimplifyKeys, edit::Scale, edit::SetCurve, edit::Splice, edit::SetPart,
                 edit::Add, edit::Duplicate, edit::Delete, edit::Rename, edit::Target, edit::Group,
                 edit::Ungroup>;

/// What an operation does, for people: `set poke.magnitude`, `move 3 keys of poke.center`.
std::string described(const Operation& operation);

}  // namespace pliant
