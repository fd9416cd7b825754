#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace pliant {

/// The text, or, of one with more than `longest` bytes, its beginning and `…`: no more than these
/// together, and whole characters.
std::string shortened(std::string_view text, std::size_t longest);

}  // namespace pliant
