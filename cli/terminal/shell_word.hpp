#pragma once

#include <span>
#include <string>
#include <string_view>

namespace pliant::cli {

/// The text as one word of a command line of bash or zsh. If it is not printable, it is `$'…'` of
/// ASCII only, so that it can be copied.
std::string shell_word(std::string_view text);

/// A command line.
std::string shell_line(std::span<const std::string> words);

}  // namespace pliant::cli
