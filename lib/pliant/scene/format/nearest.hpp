#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace pliant::xml {

/// The most likely candidate for a misspelt word, if one is near: at most one typing error (an
/// extra, missing or wrong letter, or two swapped ones) per three letters; case is ignored.
std::optional<std::string_view> nearest_word(std::string_view word,
                                             std::span<const std::string_view> candidates);

/// `; did you mean "falloff"? allowed: name, enabled, falloff`; without the question if no
/// candidate is near, and with "none" if there are no candidates.
std::string hint(std::string_view word, std::span<const std::string_view> candidates);

}  // namespace pliant::xml
