#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace pliant {

/// The text, or, of one with more than `longest` bytes, its beginning and `…`: no more than these
/// together, and whole characters.
std::string shortened(std::string_view text, std::size_t longest);

/// The text in double quotes, for one line of a message: control characters become blanks, and a
/// long text is cut.
std::string in_quotes(std::string_view text);

/// `a`, `a and b`, `a, b and c`.
std::string in_words(std::span<const std::string> words);

}  // namespace pliant
