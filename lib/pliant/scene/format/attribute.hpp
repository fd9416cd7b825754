#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace pliant {

/// The most frames that a scene may have.
inline constexpr int max_frames = 1'000'000;

/// The largest absolute value of a frame number.
inline constexpr int largest_frame = 1'000'000'000;

/// The most frames of a preroll, and of a cycle.
inline constexpr int max_preroll = 100'000;
inline constexpr int max_loop = 100'000;

/// The most vertices that a grid sheet may have.
inline constexpr int max_sheet_vertices = 100'000'000;

/// The largest width or depth of a grid sheet [length]; it keeps products of coordinates and counts
/// finite.
inline constexpr double largest_extent = 1e300;

/// Whether an attribute or element is optional, required or not supported.
enum class Need {
  Optional,
  Required,
  Later,  ///< known to the format, not supported by this version
};

/// The numbers that an attribute accepts; of a vector, each component.
struct Range {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  bool excludes_least = false;
  bool excludes_zero = false;

  /// The rule that a number breaks, such as "must be greater than 0"; null: none. Not a number
  /// breaks none.
  std::optional<std::string> broken_rule(std::span<const double> numbers) const;

  std::string to_text() const;  ///< `> 0`, `≥ 0`, `0 to 1`, `≠ 0`; empty: any finite number
};

inline constexpr Range any_number{};
inline constexpr Range positive{.least = 0, .excludes_least = true};
inline constexpr Range not_negative{.least = 0};
inline constexpr Range a_share{.least = 0, .most = 1};
inline constexpr Range not_zero{.excludes_zero = true};

/// How a text is written, if its member does not tell.
enum class Syntax {
  Plain,     ///< as its member
  Name,      ///< a letter or _, then letters, digits, _ and -
  Path,      ///< of a file, relative to the scene's folder
  Rate,      ///< a number, or a fraction of two
  Version,   ///< of the format: 1
  Position,  ///< the name of a position of the element around it
  Surface,   ///< the name of a surface, or of some
};

/// A row: one attribute of a thing.
struct Attribute {
  std::string_view name = {};
  std::string_view meaning = {};  ///< for people, in Markdown
  std::string_view unit = {};
  Range range = {};
  std::span<const std::string_view> words = {};  ///< of a word, in the order of its values
  std::span<const std::string_view> later = {};  ///< words that a later version will support
  std::string_view instead = {};                 ///< what to use instead of what is not supported
  std::string_view absent = {};                  ///< what its absence means, if that is not a value
  Need need = Need::Optional;
  Syntax syntax = Syntax::Plain;
};

/// The text in an element: numbers.
struct Numbers {
  std::string_view meaning;  ///< for people
  Range range = {};
  std::size_t together = 0;  ///< so many stand on a line; 0: all
};

inline constexpr int unlimited = std::numeric_limits<int>::max();

/// A row of the elements that a thing contains: how often they stand in it.
struct Child {
  int least = 0;
  int most = 1;
  /// The attribute in which several differ; empty: none.
  std::string_view unique_by = {};
  /// What several kinds are called of which one stands there; empty: it is one kind.
  std::string_view noun = {};
  bool is_of_driven = false;  ///< a driven surface has it too
};

/// The rows of T, a struct of scene.hpp: `rows(row, things...)` calls `row(attribute, members...)`
/// for each of them, with the member of each thing; `row(attribute)` if it is no member. Members
/// that are channels may be animated.
///
/// Of an element also its name, what it is, for people, and with `children(child, thing)` the
/// elements in it, in the order in which they are written: `child(row, member)` for each, a thing
/// that has a description, a list of such things, or a `Kinds` of things (contents.hpp).
template <class T>
struct Description;

/// Calls `row(attribute, member)` for each row of a thing.
template <class Row, class T, class... Others>
void describe(Row&& row, T& thing, Others&... others) {
  Description<std::remove_const_t<T>>::rows(row, thing, others...);
}

/// The share of a path's length, `progress` of a <path>.
inline constexpr Attribute progress_attribute{
    .name = "progress",
    .meaning = "position along the path, as a share of its length",
    .unit = "1",
    .range = a_share};

inline constexpr Range frame_range{.least = -largest_frame, .most = largest_frame};

/// The name of a surface, force or group.
constexpr Attribute name_attribute(std::string_view meaning) {
  return {.name = "name", .meaning = meaning, .need = Need::Required, .syntax = Syntax::Name};
}

}  // namespace pliant
