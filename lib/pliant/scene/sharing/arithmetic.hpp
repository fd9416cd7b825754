#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"

namespace pliant::xml {

/// The deepest nesting of parentheses and signs.
inline constexpr int deepest_arithmetic = 64;

/// The numbers that a text stands for, or why it has none.
using Numbers = Checked<std::vector<double>>;

/// A piece of a value: characters as written, or a definition that stands in their place.
struct ValuePart {
  std::string_view text;
  bool is_definition = false;
  const Numbers* numbers = nullptr;  ///< of a definition; null: it stands for no numbers
  bool is_plain = false;             ///< of a definition: a number, or several between blanks
};

/// Whether a text is a number, or several between blanks.
bool are_plain_numbers(std::string_view text);

/// The numbers of a text without definitions: one or more, separated by blanks, each of them
/// arithmetic. Null: it is something else, or has more than `most` numbers.
std::optional<Numbers> numbers_of(std::string_view text,
                                  std::size_t most = std::numeric_limits<std::size_t>::max());

/// The text of a value that is arithmetic: its numbers, separated by blanks. Null: it is not, since
/// a definition stands for no numbers, or since there are other characters than those of
/// arithmetic.
///
/// + - * / with the usual precedence, from left to right, in double precision; also − × ÷; signs,
/// parentheses, numbers. Blanks separate the numbers of a vector; a sign with a blank before and
/// none after it begins the next number (`$x -1` is two numbers, `$x - 1` is one), except in
/// parentheses. A definition of several numbers may stand alone, have a sign, be multiplied or
/// divided by one number, or be added to, or subtracted from, as many numbers. A number or
/// definition that stands alone is kept as it is written; others have the fewest digits that give
/// the same double. Faults: the syntax; division by 0; a result that is not finite; too many
/// parentheses; numbers that do not fit each other.
std::optional<Checked<std::string>> compute(std::span<const ValuePart> parts);

}  // namespace pliant::xml
