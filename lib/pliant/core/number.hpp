#pragma once

#include <optional>
#include <string_view>

namespace pliant {

/// The number that the whole text spells in the C locale, decimal and finite; nullopt for `1,5`,
/// `0x10`, `nan`, `1e999`, `1e-999`, `1.5abc` and the empty text. A leading `+` is accepted.
/// Correctly rounded.
std::optional<double> to_number(std::string_view text);

/// The integer that the whole text spells; nullopt for other texts and outside the range of int.
std::optional<int> to_integer(std::string_view text);

}  // namespace pliant
