#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/shortened.hpp"

/// The parts of the scene reader; programs need only read.hpp and format.hpp.
namespace pliant::xml {

/// XML's blanks: space, tab, carriage return, line feed.
inline constexpr std::string_view blanks = " \t\r\n";

/// The text without the blanks around it.
std::string_view trimmed(std::string_view text);

/// The parts of a text between blanks.
std::vector<std::string_view> words_of(std::string_view text);

/// One finite number in the C locale, blanks around it allowed. The whole text must be the number:
/// `1,5`, `1.5abc`, `0x10`, `+1`, `nan`, `inf` and `1e999` are complaints.
Checked<double> parse_number(std::string_view text);

/// A whole number in [least, most], written without point or exponent.
Checked<std::int64_t> parse_integer(std::string_view text, std::int64_t least, std::int64_t most);

/// A whole number in [0, 2^64).
Checked<std::uint64_t> parse_natural(std::string_view text);

/// Exactly `numbers.size()` numbers, separated by blanks; on a complaint `numbers` is unchanged.
Checked<void> parse_numbers(std::string_view text, std::span<double> numbers);

/// `true` or `false`.
Checked<bool> parse_boolean(std::string_view text);

/// A number greater than 0, or a fraction of two such as `24000/1001`: the double quotient.
Checked<double> parse_rate(std::string_view text);

/// `one, two, three`.
std::string listed(std::span<const std::string_view> words);

}  // namespace pliant::xml
