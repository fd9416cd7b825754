#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "pliant/core/result.hpp"

namespace pliant {

/// What a message quotes from a file: in quotes, and short enough to be read.
std::string in_quotes(std::string_view text);

/// Which of a file's objects is meant: the one of that name, or the only one when `object` is
/// empty. Errors, listing the first names: no object of that name, several of it, or none named
/// where there are several. Requires: names is not empty.
Result<std::size_t> choose_object(std::span<const std::string> names, const std::string& object);

/// Whether an object with `set_count` sets of (u,v) has the set `uv_set`, counted from 0. Set 0 may
/// be missing: a mesh without (u,v) is a mesh. Errors: says how many sets there are.
Result<void> check_uv_set(int uv_set, int set_count);

}  // namespace pliant
