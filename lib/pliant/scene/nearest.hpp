#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace pliant::xml {

/// The candidate that a misspelt word most likely means, if one is near: at most one typing slip (a
/// letter too many, missing, wrong, or two swapped) for each three letters; case does not count.
std::optional<std::string_view> nearest_word(std::string_view word,
                                             std::span<const std::string_view> candidates);

/// `; did you mean "falloff"? allowed: name, enabled, falloff`; without the question where no
/// candidate is near, and "none" where there are no candidates.
std::string hint(std::string_view word, std::span<const std::string_view> candidates);

}  // namespace pliant::xml
