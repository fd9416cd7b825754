#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/scene/format/key_words.hpp"
#include "pliant/scene/format/slot.hpp"
#include "pliant/timeline/key.hpp"

namespace pliant::xml {

/// The axis along which keys are placed.
enum class KeyAxis {
  Frame,    ///< time, of an <animate>
  Falloff,  ///< s = distance / force radius, 0 to 1, of a <falloff>
};

/// The attribute that places a key: `frame` or `at`.
constexpr std::string_view place_name(KeyAxis axis) {
  return axis == KeyAxis::Frame ? "frame" : "at";
}

/// One value of a curve with D components.
template <int D>
Checked<Value<D>> parse_value(std::string_view text, ValueKind kind);

/// The text of such a value.
template <int D>
std::string value_text(const Value<D>& value, ValueKind kind);

/// A handle as the file gives it: `frames value`, relative to its key.
template <int D>
struct Handle {
  double frames = 0;
  Value<D> value = {};
};

/// The attributes of a <key>. For absent ones the <animate> or the curve rules decide.
template <int D>
struct KeyText {
  double frame = 0;
  Value<D> value = {};
  std::optional<Interpolation> interpolation = {};
  std::optional<double> amplitude = {};
  std::optional<double> period = {};
  std::optional<double> back = {};
  std::optional<std::array<double, 4>> control = {};
  std::optional<Tangent<D>> tangent = {};
  std::optional<Tangent<D>> in = {};
  std::optional<Tangent<D>> out = {};
  std::optional<double> in_length = {};
  std::optional<double> out_length = {};
  std::optional<Handle<D>> in_handle = {};
  std::optional<Handle<D>> out_handle = {};
  std::optional<Value<D>> left = {};
};

// The words of the values that keys have besides numbers.

std::vector<std::string> interpolation_words();
std::vector<std::string> tangent_words();
/// Of an extrapolation. `slope` is followed by a slope, a loop perhaps by its count.
struct ExtrapolationWords {
  std::vector<std::string> plain, loops, slopes;
};
ExtrapolationWords extrapolation_words();

/// The attributes of an <animate> or a <falloff>.
template <int D>
struct AnimateText {
  Extrapolation<D> before = {};
  Extrapolation<D> after = {};
  Tangent<D> tangent = {};           ///< of keys that give none
  Interpolation interpolation = {};  ///< of keys that give none
  Overshoot overshoot = Overshoot::Limit;
};

/// The attributes of a <falloff>.
struct FalloffText : AnimateText<1> {};

// The rows of <key>, <animate> or <falloff>, and <loop>.

template <int D>
Table table_of(KeyText<D>& key, KeyAxis axis, ValueKind kind);
template <int D>
Table table_of(AnimateText<D>& animate, KeyAxis axis, ValueKind kind);
template <int D>
Table table_of(Loop<D>& loop, ValueKind kind);

}  // namespace pliant::xml

namespace pliant {

template <int D>
struct Description<xml::KeyText<D>> {
  static constexpr std::string_view element = "key";
  static constexpr std::string_view meaning = "A value of the channel at a frame.";
};

template <int D>
struct Description<xml::AnimateText<D>> {
  static constexpr std::string_view element = "animate";
  static constexpr std::string_view meaning = "Keys of a channel.";
};

template <>
struct Description<xml::FalloffText> {
  static constexpr std::string_view element = "falloff";
  static constexpr std::string_view meaning =
      "A falloff drawn by keys, placed by at = distance / forceRadius.";
};

template <int D>
struct Description<Loop<D>> {
  static constexpr std::string_view element = "loop";
  static constexpr std::string_view meaning = "A part of the keys that is repeated.";
};

}  // namespace pliant
