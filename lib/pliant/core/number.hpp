#pragma once

#include <optional>
#include <string_view>

namespace pliant {

/// The number that the whole text spells in the C locale, decimal and finite: `1,5`, `0x10`, `nan`,
/// `1e999`, `1e-999`, `1.5abc` and the empty text are none. A leading `+` is accepted. Correctly
/// rounded.
std::optional<double> to_number(std::string_view text);

/// The whole number that the whole text spells; none outside the range of int.
std::optional<int> to_integer(std::string_view text);

}  // namespace pliant
