#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "pliant/scene/format.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/scene/text.hpp"

namespace pliant::xml {

/// The numbers that an attribute accepts; of a vector, each component.
struct Range {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  bool excludes_least = false;
  bool excludes_zero = false;

  /// Complaint if a number is outside the range, such as "must be greater than 0".
  Reading<void> accept(std::span<const double> numbers) const;

  std::string to_text() const;  ///< `> 0`, `≥ 0`, `0 to 1`, `≠ 0`; empty: any finite number
};

inline constexpr Range any_number{};
inline constexpr Range positive{.least = 0, .excludes_least = true};
inline constexpr Range not_negative{.least = 0};
inline constexpr Range a_share{.least = 0, .most = 1};
inline constexpr Range not_zero{.excludes_zero = true};

/// Where the value of a channel is stored, constant or animated. Empty: the attribute is not a
/// channel.
using ChannelPlace =
    std::variant<std::monostate, Channel<1>*, Channel<3>*, std::optional<Channel<3>>*,
                 PositionChannel*, TangentChannel*, Switch*>;

/// One attribute of an element while the element is read: its format, where its value is stored,
/// and how the file gave it. A table of these, one row each, defines an element for the reader.
struct Attribute {
  AttributeFormat format;
  std::function<Reading<void>(std::string_view)> read;  ///< stores the value, or complains
  ChannelPlace channel = {};

  int line = 0;              ///< line where it is given or animated, 0: absent
  bool is_animated = false;  ///< by an <animate>, not given as an attribute
  bool is_sound = true;      ///< no problem was found with it

  /// Given or left at its default, without a problem: other values may be checked against it.
  bool is_constant() const { return is_sound && !is_animated; }
};

// The rows. Each stores its value in `place`; the value already there is the default. `place` must
// outlive the row. `range` is checked; both `unit` and `range` must match docs/scene-format.md.

Attribute channel(std::string_view name, Channel<1>& place, std::string_view unit,
                  Range range = {});
Attribute channel(std::string_view name, Channel<3>& place, std::string_view unit,
                  Range range = {});
Attribute channel(std::string_view name, std::optional<Channel<3>>& place, std::string_view unit);
Attribute channel(std::string_view name, PositionChannel& place, std::string_view unit);
Attribute channel(std::string_view name, TangentChannel& place, std::string_view unit);
Attribute channel(std::string_view name, Switch& place);

Attribute number(std::string_view name, double& place, std::string_view unit, Range range = {});
Attribute number(std::string_view name, std::optional<double>& place, std::string_view unit,
                 Range range = {});
Attribute integer(std::string_view name, int& place, std::string_view unit, std::int64_t least,
                  std::int64_t most);
Attribute integer(std::string_view name, std::optional<int>& place, std::string_view unit,
                  std::int64_t least, std::int64_t most);
Attribute boolean(std::string_view name, bool& place);
Attribute name_of(std::string& place);  ///< the required `name` of a surface or force
Attribute names(std::string_view name, std::vector<std::string>& place);

/// An attribute with its own syntax.
Attribute custom(std::string_view name, std::string_view type, std::string_view unit,
                 std::string standard, std::string range,
                 std::function<Reading<void>(std::string_view)> read);

/// One of `words`; those in `later` are known but not supported by this version.
Attribute word(std::string_view name, std::vector<std::string_view> words,
               std::vector<std::string_view> later, std::string_view standard,
               std::function<void(std::size_t)> take);

/// An enumeration, with the word for each of its values.
template <class E>
Attribute choice(std::string_view name, E& place,
                 std::vector<std::pair<std::string_view, E>> choices,
                 std::vector<std::string_view> later = {}) {
  std::vector<std::string_view> words;
  std::vector<E> values;
  std::string_view standard;
  for (const auto& [text, value] : choices) {
    words.push_back(text);
    values.push_back(value);
    if (value == place) standard = text;
  }
  return word(name, std::move(words), std::move(later), standard,
              [&place, values = std::move(values)](std::size_t chosen) { place = values[chosen]; });
}

/// A word with a single choice so far, `only`; those in `later` are not supported by this version.
Attribute fixed(std::string_view name, std::string_view only, std::vector<std::string_view> later);

/// An attribute that only a later version will support.
Attribute later(std::string_view name);

/// The row as a required attribute.
Attribute required(Attribute attribute);

/// The row with a default that is not a value of the attribute: `meaning` says what its absence
/// means.
Attribute if_absent(Attribute attribute, std::string_view meaning);

/// "is not supported by this version of pliant".
std::string not_supported();

}  // namespace pliant::xml
