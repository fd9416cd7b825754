#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "pliant/scene/format/description.hpp"
#include "pliant/scene/format/format.hpp"
#include "pliant/scene/text/text.hpp"

namespace pliant::xml {

/// An enumeration, which may be absent, or a boolean with words of its own.
struct Choice {
  void* place = nullptr;
  int (*get)(const void* place) = nullptr;  ///< -1: absent
  void (*set)(void* place, int value) = nullptr;
};

/// Where the value of an attribute is stored. Empty: nowhere.
using Place =
    std::variant<std::monostate, double*, std::optional<double>*, int*, std::optional<int>*,
                 std::uint64_t*, std::optional<std::uint64_t>*, bool*, Choice, std::string*,
                 std::vector<std::string>*, std::vector<int>*, Value<3>*, std::optional<Value<3>>*,
                 std::optional<Value<2>>*, Channel<1>*, Channel<3>*, std::optional<Channel<1>>*,
                 std::optional<Channel<3>>*, PositionChannel*, TangentChannel*, Switch*, Edges*>;

/// The place of an enumeration or boolean with words.
template <class T>
Place choice(T& place) {
  return Choice{&place,
                [](const void* from) { return static_cast<int>(*static_cast<const T*>(from)); },
                [](void* to, int value) { *static_cast<T*>(to) = static_cast<T>(value); }};
}

template <class T>
Place choice(std::optional<T>& place) {
  return Choice{
      &place,
      [](const void* from) {
        const auto& value = *static_cast<const std::optional<T>*>(from);
        return value ? static_cast<int>(*value) : -1;
      },
      [](void* to, int value) { *static_cast<std::optional<T>*>(to) = static_cast<T>(value); }};
}

/// Whether the place is a channel, so that an <animate> may name it.
bool is_channel(const Place& place);

/// One attribute of an element while the element is read: where its value is stored, and how the
/// file gave it.
struct Slot {
  Attribute attribute;
  std::string type;   ///< "number", "vector", "word", …
  std::string range;  ///< empty: anything of the type
  /// The value when the slot was made, as a file gives it: before reading, the default. Empty:
  /// none, or animated.
  std::string text;
  std::function<Checked<void>(std::string_view)> read;  ///< stores the value, or complains
  Place place = {};

  TextPlace at = {};               ///< where a file gives or animates it; unknown: it does not
  bool is_animated = false;        ///< by an <animate>, not given as an attribute
  bool is_sound = true;            ///< no problem was found with it
  std::string_view excluded = {};  ///< why it must not be given here; empty: it may be

  /// Given or left at its default, without a problem: other values may be checked against it.
  bool is_constant() const { return is_sound && !is_animated; }
};

/// The slots of an element.
using Table = std::vector<Slot>;

/// The slot of that name, or null.
Slot* find(std::span<Slot> table, std::string_view name);

/// The slot of an attribute whose value is stored in `place`, which must outlive it; the value that
/// is there is the default.
Slot slot(const Attribute& attribute, Place place = {});

/// A slot with a syntax of its own.
Slot custom(const Attribute& attribute, std::string_view type, std::string_view range,
            std::function<Checked<void>(std::string_view)> read, std::string text);

/// The row of the tables in docs/scene-format.md.
AttributeFormat format_of(const Slot& slot);

/// "is not supported by this version of pliant", and what to use instead, if anything.
std::string not_supported(std::string_view instead = {});

/// Whether a member is an enumeration, or one that may be absent.
template <class T>
inline constexpr bool is_choice = std::is_enum_v<T>;
template <class T>
inline constexpr bool is_choice<std::optional<T>> = std::is_enum_v<T>;

/// Makes a slot of each row that describes a thing.
class SlotMaker {
 public:
  void operator()(const Attribute& attribute) { table_.push_back(slot(attribute)); }

  template <class T>
  void operator()(const Attribute& attribute, T& member) {
    if constexpr (is_choice<T>) {
      table_.push_back(slot(attribute, choice(member)));
    } else if constexpr (std::is_same_v<T, bool>) {
      table_.push_back(slot(attribute, attribute.words.empty() ? Place(&member) : choice(member)));
    } else {
      table_.push_back(slot(attribute, &member));
    }
  }

  Table take() { return std::move(table_); }

 private:
  Table table_;
};

/// The slots of a thing, which must outlive them.
template <class T>
Table table_of(T& thing) {
  SlotMaker maker;
  describe(maker, thing);
  return maker.take();
}

}  // namespace pliant::xml
