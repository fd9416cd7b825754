#pragma once

#include <filesystem>
#include <string>

namespace pliant {

/// The ending of a file's name with its dot, in lower case: `.obj` for `Head.OBJ`; empty: no
/// ending.
std::string ending_of(const std::filesystem::path& file);

}  // namespace pliant
